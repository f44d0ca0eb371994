#pragma once
// Writes the false-colour films of `--heatmap`.
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/report/side_film.h"
#include "core/plane.h"
#include "encoder/coder.h"
#include "perceptual/heatmap.h"

namespace render2mpeg::app {

/// Quantity of a render shown by a false-colour film.
enum class HeatSubject {
    tolerance,  ///< a pixel's tolerance over its luminance
    cut,        ///< clusters gathered
    error,      ///< standard error of the gathered light over the pixel's luminance
    quantiser,  ///< of macroblocks
    records,    ///< that lie in a pixel
    age,        ///< frames since a pixel's light was gathered
    reuse,      ///< share of a pixel's points whose light was not gathered for them
};

/// Meaning of the subject's colours.
perceptual::HeatScale scale_of(HeatSubject subject);

/// None for other words.
std::optional<HeatSubject> heat_subject_of(const std::string& word);

/// Refuses a heatmap that has nothing to show, or that cannot be coded. Writes nothing. Throws core::Error naming it.
void check_heatmap(HeatSubject subject, const std::filesystem::path& output, const RenderJob& film);

/// A false-colour film of a render with a legend below, in square pixels.
class HeatmapFilm : public SideFilm {
  public:
    HeatmapFilm(HeatSubject subject, const std::filesystem::path& output, const RenderJob& film, WorkFolder& work);

    void lit(const LitFrame& frame) override;
    void coded(const encoder::CodedPicture& coded) override;

  private:
    void open(const Chunk& chunk) override;
    std::vector<encoder::CodedPicture> close(core::LightLevel& light) override;
    /// Coded pictures come in another order.
    void show(std::int64_t number, core::Plane<float> values);

    HeatSubject subject_;
    encoder::Codec codec_;  ///< of the film itself
    perceptual::ColorMatrix matrix_;
    perceptual::HeatScale scale_;
    std::int64_t next_ = 0;
    std::map<std::int64_t, core::Plane<float>> early_;
    std::unique_ptr<encoder::Coder> encoder_;  ///< of a chunk
};

}  // namespace render2mpeg::app
