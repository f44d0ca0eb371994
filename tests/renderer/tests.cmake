render2mpeg_test(renderer LIBS render2mpeg_renderer render2mpeg_path_tracer render2mpeg_test_stages
  WITHOUT HairLight.OfCellsThatLightEachOtherIsThatOfPaths IrradianceCache.LightsPolishedMetalForAFractionOfTheRays
          LightPaths.HoldNoCausticOfAMirrorOnTheFirstSurface LobeRays.AreAsManyAsTheToleranceAsksFor
          LobeRays.OfAFloorShowAShiningBoxHoweverFewLightPointsItHas LobeRays.OfAFloorShowTheLightOfAWall
          NearLight.IsOfTheViewBehindACut OpacityMaps.ShareWhatCardsHaveInCommonAndStayBounded
          PanoramaSeam.HasLightAsSmoothAsElsewhere Panes.CostNoPhotonsBelowASkyAndBallsDo Panes.PassTheSkyToGatherRays
          PointsOfAPixel.KeepBoundsTogether
          Roughness/GlossyFloor.IsServedByRecordsAndShowsTheWallWhereItIs/1
          Roughness/GlossyFloor.IsServedByRecordsAndShowsTheWallWhereItIs/2 Shade.IsBrighterByExactlyWhatTheLightIs
          SolidGlass.PassesTheSkyHoweverWideTheSceneIs
          SolidGlass.PassesWhatSurfacesBounceWhereCausticsHaveLightOfLamps)
