#pragma once
// Parsers of sizes, ranges, tolerances.
#include <string>
#include <vector>

#include "app/options/options.h"

/// Each throws core::Error naming the option and what would be right.
namespace render2mpeg::app {

/// "WxH" or "WXH"
Size size_from(const std::string& text);
/// "A:B"
FrameRange frames_from(const std::string& text);

/// "0.04/core-hour" or "0.60/machine-hour". Throws UsageError.
Price price_from(const std::string& text);

/// Words of a command as a shell would part them: by blanks, but not within '...' and "..."; nothing else has a
/// meaning. Throws UsageError where there are none, or a quotation does not end.
std::vector<std::string> command_from(const std::string& text);
ToleranceRequest tolerance_from(const std::string& text);

/// Ten times a level: "4.1" is 41.
int level_from(const std::string& text);
/// "180" or "180:0.25": degrees and frames.
ShutterRequest shutter_from(const std::string& text);
/// "off": 0, or visibility from core::least_visibility to core::most_visibility.
float fog_from(const std::string& text);

/// ISO of film grain; 0 for none.
int grain_from(const std::string& text);

/// "off", "static", "temporal" or "static:0.2" (strength up to core::most_glare).
GlareRequest glare_from(const std::string& text);
/// "2.8"; "off": 0, all is sharp.
float f_stop_from(const std::string& text);
/// "-1.5" EV; "auto": none.
std::optional<float> exposure_from(const std::string& text);
/// "2x3": windows by frames of each.
SampleExtent sample_from(const std::string& text);
/// "4,2,0.5": shares of 1, from the largest to the least, each once.
std::vector<float> percents_from(const std::string& text);
/// "2,4,8", ascending, each once; "none": none.
std::vector<int> quantisers_from(const std::string& text);

/// Bits, or bits per second: 6000000, 6000k, 6M, 1.5M. Errors name `what`.
std::int64_t bits_from(const std::string& text, const std::string& what);
/// "700M", "4.7G", "25000k", "1234567".
double size_in_bytes(const std::string& text);
/// Seconds: "45s", "90m", "2h", "1h30m", "1:30" (minutes and seconds), "2:00:00", "5400".
double time_in_seconds(const std::string& text);
/// The same, or 0.
double within_from(const std::string& text);

/// By its name, or as h265.
encoder::Codec codec_from(const std::string& text);
/// Names of all codecs, parted by `|`.
std::string words_of_codecs();

}  // namespace render2mpeg::app
