#include "app/farm/pieces.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "app/files/file_io.h"
#include "app/files/work_folder.h"
#include "app/options/output_kind.h"
#include "app/production/resume.h"
#include "app/system/interrupt.h"
#include "app/system/program.h"
#include "core/error.h"
#include "core/text.h"

namespace render2mpeg::app {

/// A file of a chunk in a piece.
struct PieceFile {
    std::string name;  ///< in the part's folder
    std::uint64_t bytes = 0;
    std::string checksum;
};

/// What a piece holds: its files follow each other behind it, the chunk's record last.
struct PieceHead {
    std::string film;  ///< film_of() its plan
    int chunk = 0;
    std::int64_t first = 0, last = 0;  ///< frames
    std::vector<PieceFile> files;
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PieceFile, name, bytes, checksum)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PieceHead, film, chunk, first, last, files)

namespace {

using nlohmann::json;

/// Before the head: its bytes and checksum follow, each in 16 hexadecimal digits.
constexpr std::string_view piece_mark = "render2mpeg piece 1 ";

/// A film's plan in 16 digits: its identity, and all that was settled for it.
std::string film_of(const FarmPlan& plan) {
    Checksum sum;
    sum.add(json_text(plan.facts->at("identity")));
    sum.add(json_text(plan.facts->at("settled")));
    return text_of(sum.value());
}

std::string stem_of(int chunk) {
    return fmt::format("chunk_{:05}", chunk);
}

std::string piece_name(const FarmPlan& plan, int chunk) {
    return plan.output_name + "." + stem_of(chunk);
}

/// The chunk that a file's name speaks of; none where it is no piece's of this film.
std::optional<int> chunk_named(const FarmPlan& plan, const std::filesystem::path& file) {
    const std::string name = file.filename().string(), before = plan.output_name + ".chunk_";
    int chunk = 0;
    if (!name.starts_with(before)) return {};
    const auto [end, error] = std::from_chars(name.data() + before.size(), name.data() + name.size(), chunk);
    return error == std::errc() && name == piece_name(plan, chunk) ? std::optional(chunk) : std::nullopt;
}

/// Passes bytes on and returns their checksum; none where there are fewer, or they cannot be written.
std::optional<std::string> passed(std::istream& from, std::uint64_t bytes, std::ostream* to) {
    Checksum sum;
    std::vector<char> block(1 << 20);
    while (bytes > 0) {
        const auto n = static_cast<std::streamsize>(std::min<std::uint64_t>(bytes, block.size()));
        if (!from.read(block.data(), n)) return {};
        sum.add(std::string_view(block.data(), static_cast<std::size_t>(n)));
        if (to != nullptr && !to->write(block.data(), n)) return {};
        bytes -= static_cast<std::uint64_t>(n);
    }
    return text_of(sum.value());
}

/// Whether a name leads to a chunk's file in its part's folder, and nowhere else.
bool is_inside(const std::string& name, const std::string& work_folder, int chunk) {
    const std::filesystem::path path(name);
    if (path.empty() || path.is_absolute() || path != path.lexically_normal() || !path.has_filename()) return false;
    if (*path.begin() == ".." || *path.begin() == ".") return false;
    return path.parent_path() != work_folder || path.filename().string().starts_with(stem_of(chunk) + ".");
}

/// An open piece, read up to its first file.
struct Piece {
    std::ifstream stream;
    PieceHead head;
    std::string flaw;  ///< why it is none, in words

    explicit Piece(const std::filesystem::path& file) : stream(file, std::ios::binary) {
        flaw = "it is torn, or no piece of a film";
        // chosen: a name a frame and layer, of 60 frames: 20 KB; what says more is damaged.
        constexpr std::uint64_t longest = 64 << 20;
        std::string line(piece_mark.size() + 34, ' ');
        if (!stream.read(line.data(), std::ssize(line)) || !line.starts_with(piece_mark)) return;
        std::uint64_t bytes = 0;
        const char* const digits = line.data() + piece_mark.size();
        if (std::from_chars(digits, digits + 16, bytes, 16).ec != std::errc() || bytes > longest) return;
        std::string text(bytes, ' ');
        Checksum sum;
        if (!stream.read(text.data(), std::ssize(text))) return;
        sum.add(text);
        if (line.substr(piece_mark.size() + 17, 16) != text_of(sum.value())) return;
        try {
            parsed_json(text).get_to(head);
            flaw.clear();
        } catch (const json::exception&) {
        }
    }

    /// Whether all files are what the head says, as far as they have not been read.
    bool is_whole() {
        for (const PieceFile& file : head.files)
            if (passed(stream, file.bytes, nullptr) != file.checksum) return false;
        return flaw.empty() && stream.peek() == std::ifstream::traits_type::eof();
    }
};

/// Why a piece of this name is not the plan's, in words; empty where it is.
std::string flaw_of(const Piece& piece, const FarmPlan& plan, int named) {
    const PieceHead& head = piece.head;
    if (!piece.flaw.empty()) return piece.flaw;
    if (head.film != film_of(plan)) return "it is of another film, or of another plan of this one";
    if (head.chunk != named) return fmt::format("it holds chunk {}, which is not its name's", head.chunk);
    const std::string work = work_folder_of(plan.output_name).string();
    for (const PieceFile& file : head.files)
        if (!is_inside(file.name, work, head.chunk)) return "it would be written to " + file.name;
    const bool recorded = !head.files.empty() && head.files.back().name == work + "/" + stem_of(head.chunk) + ".json";
    return recorded ? "" : "it has no record of its chunk";
}

/// Writes a piece's files into a part's folder, the record last. Returns whether all were whole.
bool unpack(Piece& piece, const std::filesystem::path& folder, WorkFolder& work) {
    for (const PieceFile& file : piece.head.files) {
        const std::filesystem::path to = folder / file.name, beside = std::filesystem::path(to) += ".taking";
        std::error_code error;
        std::filesystem::create_directories(to.parent_path(), error);
        std::ofstream out(beside, std::ios::binary | std::ios::trunc);
        const bool opened = static_cast<bool>(out);
        const std::optional<std::string> sum = passed(piece.stream, file.bytes, &out);
        out.close();
        const bool lost = !opened || !out;
        if (!lost && sum == file.checksum) {
            bring_to_disk(beside);
            work.begin("");
            std::filesystem::rename(beside, to, error);
            if (!error) continue;
        }
        const std::error_code failure = error;
        std::filesystem::remove(beside, error);
        if (lost || failure)
            throw core::Error("writing", to.string(), failure ? failure.message() : "the disk is full");
        return false;
    }
    return true;
}

/// Takes one piece; returns why it is refused, or nothing.
std::string take(Piece& piece, const FarmPlan& plan, const FilmPart& part, WorkFolder& work) {
    const Chunk chunk{piece.head.chunk, piece.head.first, piece.head.last};
    if (const auto there = work.finished({chunk}); !there.empty()) {
        const std::string name = work_folder_of(plan.output_name).string() + "/" + stem_of(chunk.index) + ".m2v";
        const std::string sum = text_of(checksum_of(there[0].file()));
        const bool same = std::ranges::any_of(
            piece.head.files, [&](const PieceFile& file) { return file.name == name && file.checksum == sum; });
        return same ? "" : fmt::format("chunk {} is there already, with other bytes", chunk.index);
    }
    return unpack(piece, plan.folder_of(part), work) ? "" : "it is torn, or was changed";
}

/// Files of the pieces in a folder by their chunks.
std::map<int, std::vector<std::filesystem::path>> pieces_in(const FarmPlan& plan, const std::filesystem::path& folder) {
    std::map<int, std::vector<std::filesystem::path>> pieces;
    std::error_code error;
    auto entry = std::filesystem::recursive_directory_iterator(folder, error);
    if (error) throw core::Error("reading", folder.string(), error.message());
    for (; entry != std::filesystem::recursive_directory_iterator(); entry.increment(error)) {
        if (const auto chunk = chunk_named(plan, entry->path()); chunk && is_file(entry->path()))
            pieces[*chunk].push_back(entry->path());
        if (error) throw core::Error("reading", folder.string(), error.message());
    }
    for (auto& [chunk, files] : pieces) std::ranges::sort(files);
    return pieces;
}

}  // namespace

std::vector<std::string> take_pieces(const FarmPlan& plan, std::span<const FilmPart> parts,
                                     const std::filesystem::path& from) {
    std::vector<std::string> refused;
    const auto pieces = pieces_in(plan, from);
    for (const FilmPart& part : parts) {
        std::optional<WorkFolder> work;
        const auto end = pieces.upper_bound(static_cast<int>(part.chunks.last));
        for (auto at = pieces.lower_bound(static_cast<int>(part.chunks.first)); at != end; ++at)
            for (const std::filesystem::path& file : at->second) {
                Piece piece(file);
                std::string flaw = flaw_of(piece, plan, at->first);
                try {
                    if (flaw.empty() && !work)
                        work.emplace(plan.folder_of(part) / plan.output_name, plan.facts->at("identity"),
                                     WorkFolder::Earlier::resumed, Locking::where_possible);
                } catch (const OutputInUse& in_use) {
                    flaw = in_use.what();
                }
                if (flaw.empty()) flaw = take(piece, plan, part, *work);
                if (!flaw.empty()) refused.push_back(core::Error("taking", file.string(), flaw).what());
            }
    }
    return refused;
}

PieceSender::PieceSender(const FarmPlan& plan, const FilmPart& part, const RenderJob& film,
                         const RenderOptions& options, const PartOptions& wish)
    : plan_(plan),
      part_(part),
      film_(film),
      options_(options),
      folder_(*wish.pieces),
      from_(wish.from),
      command_(wish.after_chunk) {
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error) throw core::Error("writing", folder_.string(), error.message());
}

void PieceSender::begin(const std::vector<ChunkFile>& earlier) {
    for (const ChunkFile& chunk : earlier) {
        if (InterruptGuard::requested()) return;
        const std::filesystem::path file = folder_ / piece_name(plan_, index_of(chunk));
        Piece piece(file);
        if (!flaw_of(piece, plan_, index_of(chunk)).empty() || !piece.is_whole()) write(chunk);
        bring(file);
    }
}

void PieceSender::send(const ChunkFile& chunk) {
    const std::lock_guard lock(mutex_);
    write(chunk);
    bring_again();
    bring(folder_ / piece_name(plan_, index_of(chunk)));
}

void PieceSender::write(const ChunkFile& chunk) const {
    const std::filesystem::path home = plan_.folder_of(part_), record = ChunkFile::record_of(chunk.file());
    std::vector<std::filesystem::path> files = images_of(film_, options_, {chunk.chunk().first, chunk.chunk().last});
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(record.parent_path(), error))
        if (entry.path().filename().string().starts_with(stem_of(index_of(chunk)) + ".") && is_file(entry.path()) &&
            entry.path() != record)
            files.push_back(entry.path());
    std::ranges::sort(files);
    files.push_back(record);

    // Sums first: what changes between is noticed.
    PieceHead head{film_of(plan_), index_of(chunk), chunk.chunk().first, chunk.chunk().last, {}};
    for (const std::filesystem::path& file : files)
        head.files.push_back({file.lexically_relative(home).string(), std::filesystem::file_size(file, error),
                              text_of(checksum_of(file))});
    const std::string text = json(head).dump();
    Checksum sum;
    sum.add(text);
    const std::filesystem::path piece = folder_ / piece_name(plan_, index_of(chunk)),
                                beside = std::filesystem::path(piece) += fmt::format(".{}.tmp", getpid());
    std::ofstream out(beside, std::ios::binary | std::ios::trunc);
    out << piece_mark << text_of(text.size()) << ' ' << text_of(sum.value()) << '\n' << text;
    bool whole = ChunkFile::reopened(chunk.file(), chunk.chunk()).has_value();
    for (std::size_t i = 0; whole && i < files.size(); ++i) {
        std::ifstream in(files[i], std::ios::binary);
        whole = passed(in, head.files[i].bytes, &out) == head.files[i].checksum;
    }
    out.close();
    if (whole && out) {
        bring_to_disk(beside);
        std::filesystem::rename(beside, piece, error);
        if (!error) return bring_name_to_disk(piece);
    }
    const std::string why = error ? error.message() : out ? "its chunk was changed meanwhile" : "it cannot be written";
    std::filesystem::remove(beside, error);
    throw core::Error("writing", piece.string(), why);
}

void PieceSender::bring(const std::filesystem::path& piece) {
    if (command_.empty()) return;
    std::vector<std::string> words = command_;
    bool named = false;
    for (std::string& word : words)
        for (std::size_t at = word.find("{}"); at != word.npos; at = word.find("{}", at + piece.string().size()))
            named = true, word.replace(at, 2, piece.string());
    if (!named) words.push_back(piece.string());
    const Finished finished = run_program(words, Output::caught, from_);
    if (finished.status == 0) return;
    failure_ = fmt::format("{} ended with status {}{}", words[0], finished.status,
                           finished.text.empty() ? "" : ": " + finished.text.substr(0, finished.text.find('\n')));
    waiting_.push_back(piece);
}

void PieceSender::bring_again() {
    for (const std::filesystem::path& piece : std::exchange(waiting_, {})) bring(piece);
}

bool PieceSender::finish() {
    // chosen: three tries in four seconds; a scheduler tries the part again after minutes.
    for (auto pause = std::chrono::milliseconds(500); !waiting_.empty() && pause < std::chrono::seconds(4);
         pause *= 2) {
        if (InterruptGuard::requested()) return false;
        std::this_thread::sleep_for(pause);
        bring_again();
    }
    if (!waiting_.empty())
        throw core::Error(
            "bringing", waiting_.front().string(),
            fmt::format("{}; {} in {}, and another try of the part brings them", failure_,
                        core::counted(waiting_.size(), "piece") + (waiting_.size() == 1 ? " stays" : " stay"),
                        folder_.string()));
    return true;
}

}  // namespace render2mpeg::app
