// Collects FFmpeg's messages, so that errors can quote them.
#include <array>
#include <cstdarg>
#include <cstdio>
#include <mutex>
#include <string_view>

#include "encoder/av/module/ffmpeg.h"

namespace render2mpeg::av {
namespace {

thread_local Messages* current = nullptr;

}  // namespace

Messages::Messages() : outer_(current) {
    static std::once_flag once;
    std::call_once(once, [] { av_log_set_callback(receive); });
    current = this;
}

Messages::~Messages() {
    current = outer_;
}

void Messages::receive(void* source, int level, const char* format, va_list arguments) {
    if (current == nullptr || level > AV_LOG_INFO) return;
    std::array<char, 512> line{};
    int with_prefix = 1;
    av_log_format_line2(source, level, format, arguments, line.data(), static_cast<int>(line.size()), &with_prefix);
    std::string text(line.data());
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    // Addresses of objects in memory ("[vob @ 0x55...]") differ from run to run and tell the user nothing.
    if (const auto at = text.find(" @ 0x"); at != std::string::npos)
        if (const auto end = text.find(']', at); end != std::string::npos) text.erase(at, end - at);

    // libavcodec reports concealed errors as information only.
    const bool concealed = std::string_view(format).substr(0, 10) == "concealing";
    if (level <= AV_LOG_ERROR || concealed) {
        if (current->error_.empty()) current->error_ = text;
    } else if (level <= AV_LOG_WARNING) {
        current->warning_ = text;
    }
}

std::string cause_of(int result, const Messages& messages) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> words{};
    if (result == AVERROR_INVALIDDATA) return "what it holds is neither a film nor sound that can be read";
    std::string cause = result < 0 && av_strerror(result, words.data(), words.size()) == 0 ? words.data() : "";
    if (messages.text().empty()) return cause.empty() ? "FFmpeg gives no reason" : cause;
    return cause.empty() ? messages.text() : cause + ": " + messages.text();
}

}  // namespace render2mpeg::av
