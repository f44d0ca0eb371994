#pragma once
// Writes the films of `--also`.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/loop/picture_coder.h"
#include "app/report/side_film.h"
#include "perceptual/display.h"

namespace render2mpeg::app {

/// Refuses another film of the render's light in a view that cannot be coded. Writes nothing. Throws core::Error naming
/// it. `asked` has a view, here and below.
void check_view_film(const SideFilmRequest& asked, const RenderJob& film);

/// Another film of the render's light, in a view and codec of its own: one for the web, one for editors, one of high
/// dynamic range. Its codec is that of the file's ending, HEVC for high dynamic range; its quantiser is as fine as the
/// render's, its effort the same.
class ViewFilm : public SideFilm {
  public:
    ViewFilm(const SideFilmRequest& asked, const RenderJob& film, WorkFolder& work);

    void lit(const LitFrame& frame) override;

  private:
    void open(const Chunk& chunk) override;
    std::vector<encoder::CodedPicture> close(core::LightLevel& light) override;

    const RenderJob& render_;
    core::View view_;
    std::optional<perceptual::Display> display_;
    std::vector<std::int64_t> shots_;
    RunStatistics statistics_;             ///< its own; nobody reads them
    std::unique_ptr<PictureCoder> coder_;  ///< of a chunk
    core::LightLevel light_;               ///< likewise
};

}  // namespace render2mpeg::app
