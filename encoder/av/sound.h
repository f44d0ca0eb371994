#pragma once

#include <filesystem>

/// A film's sound.
namespace render2mpeg::av {

/// A film's excerpt of a file's first audio stream. Converted to 48 kHz, one channel or two: MPEG audio layer II in
/// .mpg, .vob and .ts, AC-3 on DVDs and on request, AAC in .mkv and .mp4.
struct Sound {
    std::filesystem::path file;  ///< whatever libavformat reads; empty: the film is silent
    double offset = 0;           ///< seconds of the film at which the file begins; below 0 its beginning is cut off
    double seconds = 0;          ///< the film's length, where its sound ends
    bool ac3 = false;            ///< AC-3 in program and transport streams
    int channels = 2;            ///< of the film; 1 where the file has one
};

/// Bits per second and channel of AAC, and of other sound. chosen: rates at which listeners find no fault with each.
inline constexpr int aac_rate = 96'000, other_rate = 128'000;

/// How loud a film's sound is. [BS1770]
struct Loudness {
    double integrated = 0;  ///< LUFS
    double true_peak = 0;   ///< dB of full scale: highest between samples, too; finite
};

/// Whether the kind of film that a name's ending tells can have sound: all but .m2v.
bool can_have_sound(const std::filesystem::path& film);

/// Decodes all of a file's first audio stream. Returns Sound::channels. Throws core::Error where there is none or it is
/// damaged.
int channels_of_sound(const std::filesystem::path& file);

}  // namespace render2mpeg::av
