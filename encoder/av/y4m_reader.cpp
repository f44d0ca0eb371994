#include "encoder/av/y4m_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace render2mpeg::av {
namespace {

using Samples = core::Plane<std::uint8_t>;
using Siting = Y4mFormat::Siting;

std::optional<std::int64_t> whole_number(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc{} || end != text.data() + text.size() || value < 0) return {};
    return value;
}

/// "30000:1001". 0 in either place, with which files say that they do not know, gives nothing.
std::optional<core::Rational> ratio(std::string_view text, const std::string& file) {
    const std::size_t colon = text.find(':');
    const auto num = whole_number(text.substr(0, colon));
    const auto den = colon == std::string_view::npos ? std::nullopt : whole_number(text.substr(colon + 1));
    // chosen: the largest that anybody writes is a million; the limit keeps products of two within 64 bits.
    constexpr std::int64_t limit = 1 << 30;
    if (!num || !den || *num > limit || *den > limit)
        throw core::Error("reading", file, "the header's ratio " + std::string(text) + " is none");
    if (*num == 0 || *den == 0) return {};
    return core::Rational{*num, *den};
}

int extent(std::string_view text, const std::string& file) {
    const auto value = whole_number(text);
    // [H262, 6.3.3]: sizes have 14 bits.
    if (!value || *value < 1 || *value > 16383)
        throw core::Error("reading", file, "the header's size " + std::string(text) + " is not from 1 to 16383 pixels");
    return static_cast<int>(*value);
}

Siting siting_of(std::string_view tag, const std::string& file) {
    if (tag == "420" || tag == "420jpeg") return Siting::jpeg;
    if (tag == "420mpeg2") return Siting::mpeg2;
    if (tag == "420paldv") return Siting::paldv;
    throw core::Error("reading", file,
                      "pictures of kind C" + std::string(tag) +
                          " are not read: MPEG-2 Main Profile is 8-bit 4:2:0 (C420jpeg, C420mpeg2, C420paldv)");
}

void check_scanning(std::string_view tag, const std::string& file) {
    if (tag == "p" || tag == "?") return;
    throw core::Error("reading", file, "interlaced pictures (I" + std::string(tag) + ") are not read");
}

/// Weights of four neighbours for a point a quarter of the way back from sample 1 (of 0, 1, 2, 3 at -2, -1, 0, 1: from
/// the third towards the second), times 128: the cubic through the middle two. [Catmull1974]
constexpr std::array<int, 4> quarter_back{-3, 29, 111, -9};

/// Value at place i - 1/4 (direction -1) or i + 1/4 (direction 1) of a line of samples; ends are repeated.
template <class At>
std::uint8_t quarter(const At& at, int i, int last, int direction) {
    int sum = 64;
    for (int k = 0; k < 4; ++k)
        sum += quarter_back[static_cast<std::size_t>(k)] * at(std::clamp(i - direction * (k - 2), 0, last));
    return static_cast<std::uint8_t>(std::clamp(sum, 0, 128 * 255 + 127) >> 7);
}

Samples moved_across(const Samples& from, int direction) {
    Samples to(from.width(), from.height());
    for (int y = 0; y < from.height(); ++y)
        for (int x = 0; x < from.width(); ++x)
            to.at(x, y) = quarter([&](int i) { return from.at(i, y); }, x, from.width() - 1, direction);
    return to;
}

Samples moved_down(const Samples& from, int direction) {
    Samples to(from.width(), from.height());
    for (int y = 0; y < from.height(); ++y)
        for (int x = 0; x < from.width(); ++x)
            to.at(x, y) = quarter([&](int i) { return from.at(x, i); }, y, from.height() - 1, direction);
    return to;
}

/// [BT709, 3.4 and 3.5]: 255 steps of full range become 219 of luma above 16 and 224 of chroma about 128.
void limit_range(core::Picture& picture) {
    picture.luma = core::Plane<float>(picture.width(), picture.height());
    for (std::size_t i = 0; i < picture.y.size(); ++i) {
        const float luma = 16.0f + 219.0f * static_cast<float>(picture.y.values()[i]) / 255.0f;
        picture.luma.values()[i] = luma;
        picture.y.values()[i] = static_cast<std::uint8_t>(luma + 0.5f);
    }
    for (Samples* plane : {&picture.cb, &picture.cr})
        for (std::uint8_t& v : plane->values())
            v = static_cast<std::uint8_t>(128.5f + 224.0f * (static_cast<float>(v) - 128.0f) / 255.0f);
}

/// A line without its end; nothing if there is none within `longest` bytes.
std::optional<std::string> line_of(std::istream& stream, std::size_t longest) {
    std::string line;
    for (int c = stream.get(); c != '\n'; c = stream.get()) {
        if (c < 0 || line.size() >= longest) return {};
        line.push_back(static_cast<char>(c));
    }
    return line;
}

/// chosen: ffmpeg's lines are below 100 bytes; comments (X...) may lengthen them.
constexpr std::size_t longest_line = 4096;

/// Parses a stream's first line. Throws core::Error.
Y4mFormat read_header(std::istream& stream, const std::string& name) {
    Y4mFormat format;
    const auto header = line_of(stream, longest_line);
    if (!header || !(*header + " ").starts_with("YUV4MPEG2 "))
        throw core::Error("reading", name, "not a Y4M file: it does not begin with a YUV4MPEG2 header");
    std::istringstream words(header->substr(9));
    for (std::string word; words >> word;) {
        const std::string_view value = std::string_view(word).substr(1);
        switch (word[0]) {
            case 'W':
                format.width = extent(value, name);
                break;
            case 'H':
                format.height = extent(value, name);
                break;
            case 'F':
                format.hertz = ratio(value, name);
                break;
            case 'A':
                format.pixel_aspect = ratio(value, name);
                break;
            case 'I':
                check_scanning(value, name);
                break;
            case 'C':
                format.siting = siting_of(value, name);
                break;
            case 'X':
                if (value == "COLORRANGE=FULL") format.full_range = true;
                break;
            default:
                break;  // [Y4M]: unknown parameters are to be skipped
        }
    }
    if (format.width == 0 || format.height == 0)
        throw core::Error("reading", name, "the header does not say how large the pictures are");
    return format;
}

/// Checks the line that stands before a picture; `line`: none where there was none.
void check_frame(const std::optional<std::string>& line, const std::string& name, const std::string& object) {
    if (!line || !(*line + " ").starts_with("FRAME "))
        throw core::Error("reading", name, object, "it does not begin with the word FRAME");
    // [Y4M]: streams of mixed scanning say with each frame which field comes first.
    std::istringstream words(line->substr(5));
    for (std::string word; words >> word;)
        if (word[0] == 'I' && word.find_first_of("tTbB") == 1)
            throw core::Error("reading", name, object, "interlaced pictures are not read");
}

/// Reads the samples of a picture and makes them MPEG-2's. The stream has failed where they are not all there.
core::Picture read_picture(std::istream& stream, const Y4mFormat& format, std::int64_t frame) {
    core::Picture picture;
    picture.number = frame;
    picture.y = Samples(format.width, format.height);
    picture.cb = picture.cr = Samples((format.width + 1) / 2, (format.height + 1) / 2);
    for (Samples* plane : {&picture.y, &picture.cb, &picture.cr})
        stream.read(reinterpret_cast<char*>(plane->values().data()), static_cast<std::streamsize>(plane->size()));
    if (!stream) return picture;

    // Move chroma to where MPEG-2 has it. In its own samples: `jpeg` lies a quarter too far right; `paldv` has Cr a
    // quarter too high and Cb a quarter too low.
    if (format.siting == Siting::jpeg) {
        picture.cb = moved_across(picture.cb, -1);
        picture.cr = moved_across(picture.cr, -1);
    } else if (format.siting == Siting::paldv) {
        picture.cb = moved_down(picture.cb, -1);
        picture.cr = moved_down(picture.cr, 1);
    }
    if (format.full_range) limit_range(picture);
    return picture;
}

std::string frame_name(std::int64_t number) {
    return "frame " + std::to_string(number);
}

}  // namespace

Y4mReader::Y4mReader(const std::filesystem::path& file) : file_(file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file_, ignored)) throw core::Error("reading", file_.string(), "no such file");
    if (!std::filesystem::is_regular_file(file_, ignored)) throw core::Error("reading", file_.string(), "not a file");
    stream_.open(file_, std::ios::binary);
    if (!stream_) throw core::Error("reading", file_.string(), "cannot be opened");
    format_ = read_header(stream_, file_.string());
    find_frames();
}

void Y4mReader::find_frames() {
    const std::uint64_t size = std::filesystem::file_size(file_);
    const std::uint64_t columns = static_cast<std::uint64_t>(format_.width),
                        rows = static_cast<std::uint64_t>(format_.height);
    const std::uint64_t frame = columns * rows + 2 * ((columns + 1) / 2) * ((rows + 1) / 2);
    std::uint64_t at = static_cast<std::uint64_t>(stream_.tellg());
    while (at < size) {
        const std::string object = frame_name(frames());
        check_frame(line_of(stream_, longest_line), file_.string(), object);
        const std::uint64_t first = static_cast<std::uint64_t>(stream_.tellg());
        if (size - first < frame) throw core::Error("reading", file_.string(), object, "it is cut off");
        offsets_.push_back(first);
        at = first + frame;
        stream_.seekg(static_cast<std::streamoff>(at));
    }
    if (offsets_.empty()) throw core::Error("reading", file_.string(), "it holds no pictures");
}

core::Picture Y4mReader::read(std::int64_t frame) {
    EXPECTS(frame >= 0 && frame < frames());
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(offsets_[static_cast<std::size_t>(frame)]));
    core::Picture picture = read_picture(stream_, format_, frame);
    if (!stream_) throw core::Error("reading", file_.string(), frame_name(frame), "it cannot be read");
    return picture;
}

Y4mPipe::Y4mPipe(std::istream& stream, std::string name)
    : stream_(stream), name_(std::move(name)), format_(read_header(stream, name_)) {}

std::optional<core::Picture> Y4mPipe::next() {
    if (stream_.peek() == std::istream::traits_type::eof()) return {};
    check_frame(line_of(stream_, longest_line), name_, frame_name(frames_));
    core::Picture picture = read_picture(stream_, format_, frames_);
    if (!stream_) throw core::Error("reading", name_, frame_name(frames_), "it is cut off");
    ++frames_;
    return picture;
}

}  // namespace render2mpeg::av
