#pragma once
#include <cstddef>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/files/chunk_file.h"
#include "app/options/film.h"
#include "core/error.h"

namespace render2mpeg::app {

/// What differs first between two films' identities, in words a user can act on ("--quantiser was 4 and is 6"); empty
/// where nothing does.
std::string difference_of(const nlohmann::json& before, const nlohmann::json& now);

/// Another run holds the output.
class OutputInUse : public core::Error {
  public:
    using core::Error::Error;
};

/// Excludes other runs from an output while it lives. The system releases it with the process, however that ends.
class OutputLock {
  public:
    /// Locks `file`, which is made where there is none, in a folder that is made likewise. `output` is for messages.
    /// Throws OutputInUse where another run holds it, naming that run's process, and core::Error where it is a link or
    /// has another name besides: what that leads to may be anybody's. Waits for 0.2 s at most.
    OutputLock(const std::filesystem::path& file, const std::filesystem::path& output);
    ~OutputLock();
    OutputLock(const OutputLock&) = delete;
    OutputLock& operator=(const OutputLock&) = delete;

    /// Throws as the constructor does, and changes nothing.
    static void check(const std::filesystem::path& file, const std::filesystem::path& output);

  private:
    int descriptor_ = -1;
};

/// `OUT.partial/`, e.g. `film.mpg.partial/`: what there is of a film that is not whole yet, with a manifest of what it
/// belongs to. No other run can have the same one meanwhile.
class WorkFolder {
  public:
    /// What becomes of the chunks that an earlier run left.
    enum class Earlier { removed, resumed };

    /// Creates the folder, or takes it over. `identity` says which film it is for (film_identity.h). What an earlier
    /// run left there is removed, unless it is to be resumed: then it must be the same film's. Throws core::Error where
    /// it is not, naming what has changed, where another run is at work in it, or where it is not ours to empty (a
    /// link, another user's, or something else); then nothing is removed.
    WorkFolder(const std::filesystem::path& output, const nlohmann::json& identity, Earlier earlier = Earlier::removed);
    /// A folder in which nothing was begun goes, unless it knows of leftovers. All else is left as it is.
    ~WorkFolder();
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;

    /// Throws as the constructor would, and changes nothing.
    static void check(const std::filesystem::path& output);
    static void check(const std::filesystem::path& output, const nlohmann::json& identity);

    /// How many of the chunks an earlier run of the same film finished, as far as their records tell. Changes nothing.
    static std::size_t left(const std::filesystem::path& output, const nlohmann::json& identity,
                            const std::vector<Chunk>& chunks);

    /// Whether an earlier run of the same film left its work folder. Changes nothing.
    static bool is_of(const std::filesystem::path& output, const nlohmann::json& identity);

    /// The chunks that an earlier run finished, from the first on without a gap; none where none are to be resumed.
    std::vector<ChunkFile> finished(const std::vector<Chunk>& chunks) const;
    /// Removes all that is neither one of these chunks nor the folder's own.
    void drop_all_but(const std::vector<ChunkFile>& chunks);

    /// What the manifest keeps under a name for whoever resumes: null where there is nothing.
    nlohmann::json kept(const std::string& name) const;
    void keep(const std::string& name, const nlohmann::json& value);

    /// Remembers another output that is made with this one in a work folder of its own, and for what (its identity).
    void remember_companion(const std::filesystem::path& output, const nlohmann::json& identity);
    /// The outputs that this and earlier runs remembered.
    std::vector<std::filesystem::path> companions() const;

    ChunkFile open(const Chunk& chunk);
    /// A file of that name in the folder, which is begun now.
    std::filesystem::path begin(const std::string& name);
    /// The name of a file in the folder.
    std::filesystem::path place(const std::string& name) const { return folder_ / name; }
    /// Gives a file with a part of the film a name beside the film that nobody has, and remembers it as a leftover,
    /// in place of what earlier tries left, which goes where nobody has changed it. Returns the name. Throws
    /// core::Error.
    std::filesystem::path leave(const std::filesystem::path& file);
    /// When the film is whole: removes what interrupted runs left of it, where nobody has changed that since, the
    /// folders of companions that nobody goes on with, and the folder.
    void clear_away();
    /// Removes the folder with all that it holds.
    void remove();

  private:
    void take_over(Earlier earlier);
    void remove_companions() const;
    void remove_all_of(const nlohmann::json& leftovers) const;
    std::filesystem::path file_of(const Chunk& chunk) const;
    void write_manifest();

    std::filesystem::path output_, folder_;
    OutputLock lock_;
    std::unique_ptr<nlohmann::json> manifest_;  ///< `identity`, `leftovers`, `others`, `companions`, `kept`
    bool resumed_ = false, begun_ = false, removed_ = false;
};

}  // namespace render2mpeg::app
