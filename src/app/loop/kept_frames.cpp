#include "app/loop/kept_frames.h"

#include <algorithm>
#include <array>
#include <span>
#include <system_error>
#include <utility>

#include "app/files/chunk_file.h"
#include "app/files/file_io.h"
#include "app/files/work_folder.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// Least time between two states, over what the last one took to write. chosen: 20: large frames' take a hundredth of
/// their light, and are all kept; small ones come faster than a disk can take them.
constexpr double pause_over_writing = 20;

/// All bytes of a picture's planes, of which those unrounded may be empty.
std::array<std::span<std::uint8_t>, 7> bytes_of(core::Picture& picture) {
    const auto bytes = [](core::Plane<float>& plane) {
        const std::span<float> values = plane.values();
        return std::span(reinterpret_cast<std::uint8_t*>(values.data()), values.size_bytes());
    };
    return {picture.y.values(),      picture.cb.values(),     picture.cr.values(), bytes(picture.luma),
            bytes(picture.exact_cb), bytes(picture.exact_cr), bytes(picture.alpha)};
}

std::uint64_t bytes_in(core::Picture& picture) {
    std::uint64_t sum = 0;
    for (const std::span<std::uint8_t> plane : bytes_of(picture)) sum += plane.size();
    return sum;
}

std::uint64_t sum_of(core::Picture& picture) {
    Checksum sum;
    for (const std::span<std::uint8_t> plane : bytes_of(picture)) sum.add(plane);
    return sum.value();
}

void archive_text(auto& archive, std::string& text) {
    std::vector<char> letters(text.begin(), text.end());
    archive(letters);
    text.assign(letters.begin(), letters.end());
}

}  // namespace

KeptFrames::KeptFrames(KeptChunk chunk)
    : chunk_(std::move(chunk)),
      lit_(std::filesystem::path(chunk_.stream).replace_extension(".lit")),
      state_file_(std::filesystem::path(chunk_.stream).replace_extension(".state")) {
    if (is_there(state_file_)) complaint_ = why_not(state_file_);
    if (!complaint_.empty() || frames_ == 0) drop();
    std::error_code error;
    if (frames_ > 0 && chunk_.needs_pictures) {
        core::Picture picture = empty();
        std::filesystem::resize_file(lit_, static_cast<std::uint64_t>(frames_) * bytes_in(picture), error);
        earlier_.clear();
        earlier_.seekg(0);
    }
    if (chunk_.needs_pictures) stream_.open(lit_, std::ios::binary | std::ios::app);
    ends_ = error || (chunk_.needs_pictures && !stream_);
}

std::uint64_t KeptFrames::mark() const {
    Checksum sum;
    sum.add(chunk_.film);
    sum.add(std::to_string(chunk_.chunk.first) + ":" + std::to_string(chunk_.chunk.last));
    return sum.value();
}

/// Takes over what was left; says why it cannot.
std::string KeptFrames::why_not(const std::filesystem::path& state) {
    state_ = core::ArchiveReader::open(state, mark());
    if (!state_) return "is damaged, or another film's";
    std::string text;
    try {
        std::int64_t frames = 0;
        (*state_)(frames);
        archive_text(*state_, text);
        head_ = parsed_json(text);
        if (frames < 1 || frames >= chunk_.chunk.frames()) return "has other frames";
        if (chunk_.needs_pictures && !is_file(lit_)) return "has lost its pictures";
        earlier_.open(lit_, std::ios::binary);
        core::Picture picture = empty();
        for (std::int64_t i = 0; i < frames; ++i) {
            const auto k = static_cast<std::size_t>(i);
            if (chunk_.needs_pictures && (!read(picture) || head_.at("pictures").at(k) != sum_of(picture)))
                return "has lost its pictures";
            if (head_.at("products").at(k) != sums_of_products(chunk_.chunk.first + i))
                return "has other images than there are now";
        }
        frames_ = frames;
        return {};
    } catch (const std::exception&) {
        return "is damaged";
    }
}

core::Picture KeptFrames::empty() const {
    const int width = chunk_.width, height = chunk_.height;
    core::Picture picture;
    picture.y = core::Plane<std::uint8_t>(width, height);
    picture.cb = picture.cr = core::Plane<std::uint8_t>((width + 1) / 2, (height + 1) / 2);
    if (chunk_.unrounded) picture.luma = core::Plane<float>(width, height);
    if (chunk_.chroma == core::ExactChroma::full)
        picture.exact_cb = picture.exact_cr = core::Plane<float>(width, height);
    if (chunk_.chroma == core::ExactChroma::halved)
        picture.exact_cb = picture.exact_cr = core::Plane<float>((width + 1) / 2, (height + 1) / 2);
    if (chunk_.alpha) picture.alpha = core::Plane<float>(width, height);
    return picture;
}

bool KeptFrames::read(core::Picture& picture) {
    for (const std::span<std::uint8_t> plane : bytes_of(picture))
        earlier_.read(reinterpret_cast<char*>(plane.data()), static_cast<std::streamsize>(plane.size()));
    return static_cast<bool>(earlier_);
}

core::Picture KeptFrames::next(std::int64_t number) {
    core::Picture picture;
    if (chunk_.needs_pictures) {
        picture = empty();
        if (!read(picture)) throw core::Error("reading", lit_.string(), "it ends too early");
    }
    picture.number = number;
    return picture;
}

json KeptFrames::sums_of_products(std::int64_t frame) const {
    json sums = json::array();
    for (const std::filesystem::path& file : chunk_.products(frame))
        sums.push_back(is_file(file) ? json(checksum_of(file)) : json());
    return sums;
}

void KeptFrames::add(core::Picture picture) {
    if (ends_) return;
    if (chunk_.needs_pictures) {
        if (!chunk_.unrounded) picture.luma = {};
        if (chunk_.chroma == core::ExactChroma::none) picture.exact_cb = picture.exact_cr = {};
        for (const std::span<std::uint8_t> plane : bytes_of(picture))
            stream_.write(reinterpret_cast<const char*>(plane.data()), static_cast<std::streamsize>(plane.size()));
        head_["pictures"].push_back(sum_of(picture));
    }
    head_["products"].push_back(sums_of_products(picture.number));
}

void KeptFrames::keep(RunStatistics statistics, bool at_once, const std::function<void(core::ArchiveWriter&)>& save) {
    const double begin = clock_seconds();
    if (ends_ || (begin < due_ && !at_once)) return;
    chunk_.add_times(statistics);
    head_["statistics"] = json_of(statistics);
    auto frames = static_cast<std::int64_t>(head_.at("products").size());
    std::string text = head_.dump();
    try {
        if (!stream_.flush()) throw core::Error("writing", lit_.string(), "the disk is full");
        core::ArchiveWriter state(state_file_, mark());
        state(frames);
        archive_text(state, text);
        save(state);
        state.finish();
        frames_ = frames;
    } catch (const core::Error&) {
        ends_ = true;
        drop();
    }
    const double end = clock_seconds();
    due_ = end + pause_over_writing * (end - begin);
}

void KeptFrames::drop() {
    std::error_code ignored;
    std::filesystem::remove(state_file_, ignored);
    std::filesystem::remove(lit_, ignored);
    // An open file would keep its place on the disk.
    stream_.close();
    earlier_.close();
    frames_ = 0;
    head_ = {{"pictures", json::array()}, {"products", json::array()}};
    state_.reset();
}

std::int64_t KeptFrames::left_beside(const std::filesystem::path& stream, const Chunk& chunk) {
    const std::filesystem::path state = std::filesystem::path(stream).replace_extension(".state");
    if (!is_file(state)) return 0;
    std::ifstream file(state, std::ios::binary);
    std::int64_t frames = 0;
    file.seekg(core::ArchiveReader::header_bytes);
    file.read(reinterpret_cast<char*>(&frames), sizeof frames);
    return file && frames > 0 && frames < chunk.frames() ? frames : 0;
}

std::int64_t lit_frames_in(const std::filesystem::path& output, const std::vector<Chunk>& chunks) {
    std::int64_t lit = 0;
    for (const Chunk& chunk : chunks) {
        const std::filesystem::path stream = WorkFolder::stream_of(output, chunk);
        if (!is_there(ChunkFile::record_of(stream))) lit += KeptFrames::left_beside(stream, chunk);
    }
    return lit;
}

}  // namespace render2mpeg::app
