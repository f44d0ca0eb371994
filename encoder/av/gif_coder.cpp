#include "encoder/av/gif_coder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "core/error.h"
#include "encoder/av/access_unit.h"
#include "encoder/av/gif_codes.h"
#include "encoder/av/gif_palette.h"

namespace render2mpeg::av {
namespace {

/// Code values by which a pixel may differ from what it was painted for. chosen: 3 (of 0 to 8): less than what dither
/// of 255 colours does.
constexpr float most_difference = 3;

/// Hundredths of a second from the film's beginning to a picture, rounded.
std::int64_t hundredths_before(const encoder::Settings& settings, std::int64_t number) {
    return std::llround(100 * static_cast<double>(number - settings.first_number) / settings.rate.hertz.value());
}

/// Errors of dither that go to the pixels behind one, and to those below. [Floyd1976]
class Dither {
  public:
    explicit Dither(int width) : here_(static_cast<std::size_t>(width) + 2), below_(here_.size()) {}

    /// Rows go to the right and to the left in turn.
    void begin_row() {
        std::swap(here_, below_);
        std::ranges::fill(below_, Rgb{});
        step_ = -step_;
    }
    int step() const { return step_; }
    Rgb corrected(int x, const Rgb& wanted) const {
        Rgb sum = wanted;
        for (std::size_t c = 0; c < 3; ++c) sum[c] = std::clamp(sum[c] + here_[place(x)][c], 0.0f, 255.0f);
        return sum;
    }
    void spread(int x, const Rgb& error) {
        for (std::size_t c = 0; c < 3; ++c) {
            here_[place(x + step_)][c] += error[c] * 7 / 16;
            below_[place(x - step_)][c] += error[c] * 3 / 16;
            below_[place(x)][c] += error[c] * 5 / 16;
            below_[place(x + step_)][c] += error[c] * 1 / 16;
        }
    }

  private:
    static std::size_t place(int x) { return static_cast<std::size_t>(x + 1); }
    std::vector<Rgb> here_, below_;
    int step_ = -1;
};

}  // namespace

GifCoder::GifCoder(const encoder::Settings& settings)
    : settings_(settings),
      matrix_(RgbMatrix::usual(settings.height)),
      wanted_(settings.width, settings.height),
      painted_(settings.width, settings.height),
      shown_(settings.width, settings.height),
      is_new_(settings.width, settings.height) {}

encoder::PicturePlan GifCoder::plan(std::int64_t number, const encoder::PictureFacts&, bool first_of_chunk) {
    encoder::PicturePlan plan;
    plan.number = number;
    plan.starts_gop = first_of_chunk || !last_;
    plan.type = plan.starts_gop ? encoder::PictureType::intra : encoder::PictureType::predicted;
    plan.quantiser = 1;
    last_ = number;
    return plan;
}

Rgb GifCoder::wanted(const core::Picture& picture, int x, int y) const {
    const float luma = picture.luma.empty() ? static_cast<float>(picture.y.at(x, y)) : picture.luma.at(x, y);
    if (!picture.exact_cb.empty()) return matrix_.to_rgb({luma, picture.exact_cb.at(x, y), picture.exact_cr.at(x, y)});
    const auto chroma = [&](const core::Plane<std::uint8_t>& plane) {
        const int left = x / 2, right = std::min(left + x % 2, plane.width() - 1), row = y / 2;
        return 0.5f * static_cast<float>(plane.at(left, row) + plane.at(right, row));
    };
    return matrix_.to_rgb({luma, chroma(picture.cb), chroma(picture.cr)});
}

std::optional<GifCoder::Part> GifCoder::find_changes(const core::Picture& picture, bool whole) {
    Part part{settings_.width, settings_.height, 0, 0};
    for (int y = 0; y < settings_.height; ++y)
        for (int x = 0; x < settings_.width; ++x) {
            const Rgb color = wanted_.at(x, y) = wanted(picture, x, y);
            bool is_new = whole;
            if (settings_.alpha) {
                is_new = picture.alpha.empty() || picture.alpha.at(x, y) >= 0.5f;
                if (!is_new) shown_.at(x, y) = {};
            } else if (!whole) {
                for (std::size_t c = 0; c < 3; ++c)
                    is_new = is_new || std::abs(color[c] - painted_.at(x, y)[c]) > most_difference;
            }
            is_new_.at(x, y) = is_new ? 1 : 0;
            if (!is_new) continue;
            part = {std::min(part.left, x), std::min(part.top, y), std::max(part.right, x + 1),
                    std::max(part.bottom, y + 1)};
        }
    return part.right > 0 ? std::optional(part) : std::nullopt;
}

std::vector<std::uint8_t> GifCoder::paint(const Part& part, const GifPalette& palette) {
    const int width = part.right - part.left;
    std::vector<std::uint8_t> indices(static_cast<std::size_t>(width * (part.bottom - part.top)),
                                      static_cast<std::uint8_t>(palette.colors().size()));
    Dither dither(width);
    for (int y = part.top; y < part.bottom; ++y) {
        dither.begin_row();
        for (int i = 0; i < width; ++i) {
            const int column = dither.step() > 0 ? i : width - 1 - i, x = part.left + column;
            if (is_new_.at(x, y) == 0) continue;
            const Rgb color = dither.corrected(column, wanted_.at(x, y));
            const std::size_t index = palette.nearest(color);
            Rgb error{};
            for (std::size_t c = 0; c < 3; ++c) {
                shown_.at(x, y)[c] = palette.colors()[index][c];
                error[c] = color[c] - shown_.at(x, y)[c];
            }
            dither.spread(column, error);
            painted_.at(x, y) = wanted_.at(x, y);
            indices[static_cast<std::size_t>((y - part.top) * width + column)] = static_cast<std::uint8_t>(index);
        }
    }
    return indices;
}

std::vector<encoder::CodedPicture> GifCoder::push(const core::Picture& picture, const encoder::PicturePlan& plan,
                                                  std::span<const core::MotionField>, const encoder::Hints&) {
    GifImage image;
    image.hundredths =
        static_cast<int>(hundredths_before(settings_, plan.number + 1) - hundredths_before(settings_, plan.number));
    image.is_cleared = settings_.alpha;
    std::optional<GifPalette> palette;
    if (const std::optional<Part> part = find_changes(picture, plan.starts_gop)) {
        std::vector<Rgb> pixels;
        for (std::size_t i = 0; i < is_new_.size(); ++i)
            if (is_new_.values()[i] != 0) pixels.push_back(wanted_.values()[i]);
        palette.emplace(pixels);
        image.colors = palette->colors();
        image.x = part->left, image.y = part->top;
        image.width = part->right - part->left, image.height = part->bottom - part->top;
        image.indices = paint(*part, *palette);
    } else {
        image.indices = {0};  // an open pixel lasts as long
    }

    encoder::CodedPicture coded;
    coded.plan = plan;
    coded.quantiser = plan.quantiser;
    coded.coding_order = coding_order_++;
    coded.bytes = put_together(gif_header(settings_.width, settings_.height), gif_image(image));
    coded.reconstruction =
        picture_of_rgb(settings_.width, settings_.height, matrix_, [&](int x, int y) { return shown_.at(x, y); });
    coded.reconstruction.number = plan.number;
    coded.macroblocks =
        core::Plane<encoder::MacroblockRecord>((settings_.width + 15) / 16, (settings_.height + 15) / 16);
    coded.tells_vectors = false;
    std::vector<encoder::CodedPicture> complete;
    complete.push_back(std::move(coded));
    return complete;
}

void check_gif(const encoder::Settings& settings) {
    constexpr double fastest = 50;  // players show what lasts less than 2 hundredths of a second for 10
    if (settings.rate.hertz.value() > fastest)
        throw core::Error("coding", "GIF",
                          "players show 50 pictures per second at most, these are " + settings.rate.name +
                              "; choose another --fps, or .webm");
}

}  // namespace render2mpeg::av
