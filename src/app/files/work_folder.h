#pragma once
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/files/chunk_file.h"
#include "app/options/film.h"
#include "core/error.h"

namespace render2mpeg::app {

/// First member in which two films' identities differ ("--quantiser was 4 and is 6"); empty without one.
std::string difference_of(const nlohmann::json& before, const nlohmann::json& now);

class OutputInUse : public core::Error {
  public:
    using core::Error::Error;
};

/// Whether a folder is refused where its file system has no locks: only without another run it may do without.
enum class Locking { needed, where_possible };

/// Lock of an output; the system releases it with the process.
class OutputLock {
  public:
    /// Locks `file`, made with its folder if missing; `output` is for messages. Throws OutputInUse, naming the process,
    /// where another run holds it for 0.2 s, and core::Error where it is a link or has several names.
    OutputLock(const std::filesystem::path& file, const std::filesystem::path& output,
               Locking locking = Locking::needed);
    ~OutputLock();
    OutputLock(const OutputLock&) = delete;
    OutputLock& operator=(const OutputLock&) = delete;

    /// Throws as the constructor does; changes nothing.
    static void check(const std::filesystem::path& file, const std::filesystem::path& output);

  private:
    int descriptor_ = -1;
};

/// `OUT.partial/`: an unfinished film and its manifest, locked against other runs.
class WorkFolder {
  public:
    enum class Earlier { removed, resumed };

    /// Creates the folder, or takes it over. `identity`: the film (resume.h). Earlier content is removed, or
    /// resumed if it is of the same film. Throws core::Error, and removes nothing, where it is another film's, in use,
    /// or not ours to empty (a link, another user's).
    WorkFolder(const std::filesystem::path& output, const nlohmann::json& identity, Earlier earlier = Earlier::removed,
               Locking locking = Locking::needed);
    /// Removes an unused folder.
    ~WorkFolder();
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;

    /// Throws as the constructor would; changes nothing.
    static void check(const std::filesystem::path& output);
    static void check(const std::filesystem::path& output, const nlohmann::json& identity);

    /// Those of the chunks that are finished by their records, of the same film. Changes nothing.
    static std::vector<Chunk> left(const std::filesystem::path& output, const nlohmann::json& identity,
                                   const std::vector<Chunk>& chunks);

    /// Place of a finished chunk's record.
    static std::filesystem::path record_of(const std::filesystem::path& output, const Chunk& chunk);

    static bool is_of(const std::filesystem::path& output, const nlohmann::json& identity);

    /// Finished chunks, with gaps. `of`: of a heatmap's streams, by name; empty: the film's.
    std::vector<ChunkFile> finished(const std::vector<Chunk>& chunks, const std::string& of = {}) const;
    /// Removes everything else but the folder's own files, and lit frames of chunks in the making.
    void drop_all_but(const std::vector<ChunkFile>& chunks, const std::vector<Chunk>& in_the_making = {});
    /// Place of a chunk's stream.
    std::filesystem::path stream_of(const Chunk& chunk) const;
    static std::filesystem::path stream_of(const std::filesystem::path& output, const Chunk& chunk);

    /// Kept value; null where there is none.
    nlohmann::json kept(const std::string& name) const;
    void keep(const std::string& name, const nlohmann::json& value);

    /// Keeps other runs from another output, too, until this folder is removed. Throws as the constructor does.
    void hold(const std::filesystem::path& output);

    /// `of`: as in finished().
    ChunkFile open(const Chunk& chunk, const std::string& of = {});
    /// Place of a file that keeps the folder from being removed unused.
    std::filesystem::path begin(const std::string& name);
    std::filesystem::path place(const std::string& name) const { return folder_ / name; }
    void remove();

  private:
    void take_over(Earlier earlier);
    void write_manifest();

    std::filesystem::path folder_;
    Locking locking_;
    OutputLock lock_;
    std::unique_ptr<nlohmann::json> manifest_;  ///< `identity`, `kept`, `held`
    std::vector<std::unique_ptr<WorkFolder>> held_;
    bool resumed_ = false, begun_ = false, removed_ = false;
};

}  // namespace render2mpeg::app
