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
};

/// Whether the kind of film that a name's ending tells can have sound: all but .m2v.
bool can_have_sound(const std::filesystem::path& film);

/// Decodes all of a file's first audio stream. Returns its length in seconds. Throws core::Error where there is none or
/// it is damaged.
double length_of_sound(const std::filesystem::path& file);

}  // namespace render2mpeg::av
