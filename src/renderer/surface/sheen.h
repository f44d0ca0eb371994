#pragma once

namespace render2mpeg::renderer {

/// Reflectance of Charlie's sheen of colour 1 under even light, seen at this cosine to the normal (0..1): the integral
/// of D V cos over light directions, alpha = roughness squared, interpolated between 16 x 16 of them. Below roughness
/// 0.1 as at 0.1. [KHR_materials_sheen]
float sheen_albedo(float cosine, float roughness);

/// The same of Blender's fibres from version 4 on [Zeltner2022]: a fit to balls in an even world by Cycles 4.5, within
/// 0.01 from cosine 0.07 and roughness 0.1 on; below as there.
float microfibre_albedo(float cosine, float roughness);

}  // namespace render2mpeg::renderer
