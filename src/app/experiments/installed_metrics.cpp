#include "app/experiments/installed_metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <optional>

#include "app/files/temporary_folder.h"
#include "app/system/program.h"
#include "core/error.h"
#include "encoder/av/y4m.h"

namespace render2mpeg::app {
namespace {

/// The last line of its output, which warnings may stand before. Throws core::Error with it where the program fails.
std::string last_line_of(const std::vector<std::string>& words, const std::filesystem::path& folder) {
    const Finished finished = run_program(words, Output::caught, folder);
    const std::size_t end = finished.text.find_last_not_of(" \n");
    const std::string said = end == std::string::npos ? "" : finished.text.substr(0, end + 1);
    const std::string last = said.substr(said.rfind('\n') + 1);
    if (finished.status != 0) throw core::Error("running", words[0], last.empty() ? "it failed without a word" : last);
    return last;
}

/// The number that a text begins with, which may be infinite.
std::optional<double> number_in(const std::string& text) {
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    if (end == text.c_str()) return std::nullopt;
    return number;
}

/// In smaller pictures the filter's blocks have no size, on which ffmpeg 7.1 ends.
constexpr int least_pixels = 2025;

/// Pictures twice each: the second one does not move.
void write_still(const std::filesystem::path& file, std::span<const JudgedPicture> pictures,
                 core::Picture JudgedPicture::*which) {
    const core::Picture& first = pictures.front().*which;
    av::Y4mWriter writer(file, first.width(), first.height(), {{25, 1}, 3, "25"});
    for (const JudgedPicture& judged : pictures)
        for (int twice = 0; twice < 2; ++twice) writer.write(judged.*which);
    writer.finish();
}

std::vector<double> xpsnr_of(std::span<const JudgedPicture> pictures) {
    if (pictures.front().reference.y.size() < least_pixels) return {};
    const TemporaryFolder folder;
    write_still(folder.file("reference.y4m"), pictures, &JudgedPicture::reference);
    write_still(folder.file("decoded.y4m"), pictures, &JudgedPicture::decoded);
    last_line_of({"ffmpeg", "-v", "error", "-nostdin", "-i", "reference.y4m", "-i", "decoded.y4m", "-lavfi",
                  "xpsnr=stats_file=xpsnr.txt", "-f", "null", "-"},
                 folder.file(""));
    std::ifstream lines(folder.file("xpsnr.txt"));
    std::vector<double> found;
    std::size_t picture = 0;
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("n:")) continue;
        const std::size_t at = line.find("XPSNR y: ");
        const std::optional<double> value = at == std::string::npos ? std::nullopt : number_in(line.substr(at + 9));
        if (value && ++picture % 2 == 0) found.push_back(*value);
    }
    if (found.size() != pictures.size())
        throw core::Error("running", "ffmpeg", "its filter xpsnr tells another number of pictures");
    return found;
}

void write_ppm(const std::filesystem::path& file, const core::Picture& picture,
               const perceptual::PictureColors& colors) {
    const std::vector<std::uint8_t> rgb = perceptual::shown_rgb(picture, colors);
    std::ofstream stream(file, std::ios::binary);
    stream << "P6\n" << picture.width() << ' ' << picture.height() << "\n255\n";
    stream.write(reinterpret_cast<const char*>(rgb.data()), static_cast<std::streamsize>(rgb.size()));
    if (!stream.flush()) throw core::Error("writing", file.string(), "the disk is full");
}

std::vector<double> ssimulacra2_of(std::span<const JudgedPicture> pictures, const perceptual::PictureColors& colors) {
    const TemporaryFolder folder;
    std::vector<double> found;
    for (const JudgedPicture& judged : pictures) {
        write_ppm(folder.file("reference.ppm"), judged.reference, colors);
        write_ppm(folder.file("decoded.ppm"), judged.decoded, colors);
        const std::optional<double> value =
            number_in(last_line_of({"ssimulacra2", "reference.ppm", "decoded.ppm"}, folder.file("")));
        if (!value) throw core::Error("running", "ssimulacra2", "it tells no number");
        found.push_back(*value);
    }
    return found;
}

}  // namespace

MeanAndLow mean_and_low(std::vector<double> values) {
    if (values.empty()) return {};
    std::ranges::sort(values);
    const auto mean = [&](std::size_t count) {
        const auto end = values.begin() + static_cast<std::ptrdiff_t>(count);
        return std::accumulate(values.begin(), end, 0.0) / static_cast<double>(count);
    };
    constexpr std::size_t twentieth = 20;
    return {mean(values.size()), mean(std::max<std::size_t>(1, values.size() / twentieth))};
}

InstalledMetrics::InstalledMetrics()
    : has_xpsnr_(
          is_installed("ffmpeg") &&
          run_program({"ffmpeg", "-hide_banner", "-h", "filter=xpsnr"}, Output::caught).text.find("Filter xpsnr") !=
              std::string::npos),
      has_ssimulacra2_(is_installed("ssimulacra2")) {}

std::string InstalledMetrics::missing() const {
    std::string text;
    if (!has_xpsnr_) text = "XPSNR is missing: it wants ffmpeg 7.1 or newer";
    if (!has_ssimulacra2_)
        text += std::string(text.empty() ? "SSIMULACRA2 is missing: it wants" : "; SSIMULACRA2:") +
                " libjxl's program ssimulacra2";
    return text.empty() ? text : text + ".";
}

InstalledQuality InstalledMetrics::of(std::span<const JudgedPicture> pictures,
                                      const perceptual::PictureColors& colors) const {
    const auto known = [&](bool is_there, auto&& values) {
        return mean_and_low(is_there && !pictures.empty() ? values() : std::vector<double>());
    };
    return {known(has_xpsnr_, [&] { return xpsnr_of(pictures); }),
            known(has_ssimulacra2_ && !colors.view.is_hdr(), [&] { return ssimulacra2_of(pictures, colors); })};
}

}  // namespace render2mpeg::app
