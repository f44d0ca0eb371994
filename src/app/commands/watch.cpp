#include "app/commands/commands.h"

#include <fmt/format.h>

#include <sys/stat.h>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "app/commands/live.h"
#include "app/commands/render_stream.h"
#include "app/files/output_stream.h"
#include "app/files/publish.h"
#include "app/loop/pipeline.h"
#include "app/options/film.h"
#include "app/options/usage_error.h"
#include "app/production/production.h"
#include "app/production/resume.h"
#include "app/system/interrupt.h"
#include "app/system/program.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "encoder/encoder.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// Tells when files have changed, by size and time, and when changes have settled. Replaced and missing files have
/// changed.
class WatchedFiles {
  public:
    /// Empty names are skipped; of folders their direct files count.
    explicit WatchedFiles(std::vector<std::filesystem::path> files);

    /// Looks at most five times a second.
    bool have_changed();
    void note_change() { changed_ = true; }
    /// Waits for a change and `settled` time without one; missing files are waited for. False where `goes_on`, asked
    /// ten times a second, says no.
    bool wait(std::chrono::milliseconds settled, const std::function<bool()>& goes_on);

  private:
    struct State {
        std::int64_t seconds = 0, nanoseconds = 0;
        std::uint64_t size = 0, inode = 0;
        bool there = false;
        bool operator==(const State&) const = default;
    };
    using States = std::map<std::filesystem::path, State>;
    States look() const;

    std::vector<std::filesystem::path> files_;
    States before_;
    std::chrono::steady_clock::time_point looked_;
    bool changed_ = false;
};

using Clock = std::chrono::steady_clock;

WatchedFiles::WatchedFiles(std::vector<std::filesystem::path> files)
    : files_(std::move(files)), before_(look()), looked_(Clock::now()) {}

WatchedFiles::States WatchedFiles::look() const {
    States states;
    const auto add = [&](const std::filesystem::path& file) {
        struct stat found {};
        State state;
        if (stat(file.c_str(), &found) == 0)
            state = {found.st_mtim.tv_sec, found.st_mtim.tv_nsec, static_cast<std::uint64_t>(found.st_size),
                     found.st_ino, true};
        states[file] = state;
    };
    for (const std::filesystem::path& file : files_) {
        if (file.empty()) continue;
        std::error_code error;
        if (!std::filesystem::is_directory(file, error)) {
            add(file);
            continue;
        }
        for (const auto& entry : std::filesystem::directory_iterator(file, error))
            if (entry.is_regular_file(error)) add(entry.path());
    }
    return states;
}

bool WatchedFiles::have_changed() {
    // chosen: 200 ms; a look at a thousand files takes one or two.
    if (changed_ || Clock::now() - looked_ < std::chrono::milliseconds(200)) return changed_;
    looked_ = Clock::now();
    changed_ = look() != before_;
    return changed_;
}

bool WatchedFiles::wait(std::chrono::milliseconds settled, const std::function<bool()>& goes_on) {
    constexpr std::chrono::milliseconds beat{100};
    while (!have_changed()) {
        if (!goes_on()) return false;
        std::this_thread::sleep_for(beat);
    }
    States last = look();
    for (Clock::time_point since = Clock::now(); Clock::now() - since < settled;) {
        if (!goes_on()) return false;
        std::this_thread::sleep_for(beat);
        States now = look();
        const bool missing = std::any_of(now.begin(), now.end(), [&](const auto& entry) {
            const auto found = before_.find(entry.first);
            return !entry.second.there && found != before_.end() && found->second.there;
        });
        if (now != last || missing) since = Clock::now();
        last = std::move(now);
    }
    return true;
}

using Clock = std::chrono::steady_clock;

/// Pause without changes after which files count as whole. chosen: 500 ms; exporters pause for less.
constexpr std::chrono::milliseconds settled{500};

std::filesystem::path scene_file(const RenderOptions& options) {
    return std::filesystem::is_directory(options.input) ? options.input / "film.json" : options.input;
}

std::vector<std::filesystem::path> files_of(const RenderJob& film, const RenderOptions& options) {
    std::vector<std::filesystem::path> files{scene_file(options)};
    for (const Files& input : inputs_of(film, options))
        if (input.name != options.input) files.push_back(input.name);
    return files;
}

/// Files to watch where the scene cannot be read: it, and its neighbours.
std::vector<std::filesystem::path> files_about(const RenderOptions& options) {
    const std::filesystem::path scene = scene_file(options);
    return {scene, scene.has_parent_path() ? scene.parent_path() : "."};
}

/// A coded film, to be shown again.
class Reel : public LoopObserver {
  public:
    void coded(const encoder::CodedPicture& picture) override { pictures_.push_back(picture.bytes); }
    /// Shows it in a loop at its own rate while `goes_on` says so.
    void play(OutputStream& out, double rate, const std::function<bool()>& goes_on) const {
        Clock::time_point due = Clock::now() + std::chrono::seconds(1);  // the end is seen for a while
        while (!pictures_.empty())
            for (const std::vector<std::uint8_t>& picture : pictures_) {
                while (Clock::now() < due) {
                    if (!goes_on()) return;
                    std::this_thread::sleep_for(
                        std::min<Clock::duration>(due - Clock::now(), std::chrono::milliseconds(100)));
                }
                if (!goes_on() || !out.put(picture)) return;
                due += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate));
            }
    }

  private:
    std::vector<std::vector<std::uint8_t>> pictures_;
};

/// Shows draft after draft in a player.
class Show {
  public:
    explicit Show(const RenderOptions& options) : options_(options) {}

    /// Shows a draft in a loop until its files change.
    void show(const std::function<bool()>& goes_on) {
        RunStatistics statistics;
        files_.emplace(files_about(options_));
        WatchedFiles scene({scene_file(options_)});  // it may change while it is read
        RenderJob film = prepare_within_memory(options_);
        if (!options_.memory) film.images->read_ahead(image_probes(false));
        files_.emplace(files_of(film, options_));
        if (!options_.quiet) print_notes(film, options_);
        settle(film, options_, nullptr, statistics);
        open_player(film);
        const auto is_current = [&] {
            out_->check();
            return goes_on() && !scene.have_changed() && !files_->have_changed();
        };
        draw(film, statistics, is_current);
        if (scene.have_changed()) files_->note_change();
    }

    /// Waits for a change; false where there will be none.
    bool wait(const std::function<bool()>& goes_on) {
        return files_->wait(settled, [&] {
            if (out_) out_->check();
            return goes_on();
        });
    }
    bool has_closed() { return out_ && out_->has_lost_reader(); }

  private:
    /// Until the draft is stale or unwanted.
    void draw(const RenderJob& film, RunStatistics& statistics, const std::function<bool()>& is_current) {
        const std::unique_ptr<Sink> stream = stream_into(*out_, "-.m2v", film);
        Reel reel;
        LoopObservers both;
        both.add(*stream);
        both.add(reel);
        const Clock::time_point start = Clock::now();
        const bool whole = render_through(film, both, statistics, is_current);
        stream->finish();
        if (!whole) return;
        if (!options_.quiet)
            print_line(fmt::format("{}: {} frames in {:.1f} s", options_.input.string(), film.frame_count(),
                                   std::chrono::duration<double>(Clock::now() - start).count()));
        reel.play(*out_, film.rate.hertz.value(), is_current);
    }
    void open_player(const RenderJob& film) {
        const std::string rate = fmt::format("{}/{}", film.rate.hertz.num, film.rate.hertz.den);
        if (player_ && rate == rate_) return;
        out_.reset();
        player_ = std::make_unique<Player>(options_.player, "render2mpeg draft: " + options_.input.string(), rate);
        out_ = std::make_unique<OutputStream>(player_->descriptor(), player_->name());
        rate_ = rate;
    }

    const RenderOptions& options_;
    std::optional<WatchedFiles> files_;
    std::unique_ptr<Player> player_;
    std::unique_ptr<OutputStream> out_;  ///< after the player: it goes first
    std::string rate_;
};

bool not_interrupted() {
    return !InterruptGuard::requested();
}

int watch_in_player(const RenderOptions& options) {
    const parallel::ThreadLimit threads(options.threads);
    const InterruptGuard guard(true);
    Show show(options);
    try {
        while (not_interrupted()) {
            try {
                show.show(not_interrupted);
            } catch (const core::Error& error) {
                if (show.has_closed()) throw;
                print_error(error.what());
            }
            if (!show.wait(not_interrupted)) break;
        }
    } catch (const core::Error&) {
        if (!show.has_closed()) throw;
        print_line("the player was closed");
        return 0;
    }
    return InterruptGuard::status();
}

int watch_in_file(const RenderOptions& options, const std::string& command) {
    for (;;) {
        WatchedFiles files(files_about(options));
        WatchedFiles scene({scene_file(options)});  // it may change while it is read
        try {
            {
                const InterruptGuard guard(true);
                files = WatchedFiles(files_of(prepare_within_memory(options), options));
                if (!not_interrupted()) return InterruptGuard::status();
            }
            const int status = render(options, command);
            if (status != 0) return status;
        } catch (const Interrupted& error) {
            print_error(error.what());
            return InterruptGuard::status();
        } catch (const core::Error& error) {
            print_error(error.what());
        }
        const InterruptGuard guard(true);
        if (scene.have_changed()) files.note_change();
        if (!files.wait(settled, not_interrupted)) return InterruptGuard::status();
    }
}

}  // namespace

int watch(const RenderOptions& options, const std::string& command) {
    if (options.resume) throw UsageError("--resume: what is watched is made anew whenever it changes");
    // A broken scene may be mended; a missing one was mistyped.
    check_scene(options.input);
    if (options.live) return watch_live(options);
    if (options.output.empty()) {
        if (codec_of(options.coding, {}) != encoder::Codec::mpeg2)
            throw UsageError(options.as_said("--codec") + ": a player is sent bare MPEG-2; watch into a file, -o");
        Player::check(options.player);
        return watch_in_player(options);
    }
    check_reachable(options.output);
    return watch_in_file(options, command);
}

}  // namespace render2mpeg::app
