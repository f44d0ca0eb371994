#include "app/publish.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include "app/output_kind.h"
#include "core/error.h"

namespace render2mpeg::app {

void check_reachable(const std::filesystem::path& file) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) throw core::Error("writing", file.string(), "it is a folder");
    // The folders that are there already; the others will be made in the last of them.
    std::filesystem::path folder = std::filesystem::absolute(file, error).lexically_normal().parent_path();
    while (!std::filesystem::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
    if (!std::filesystem::is_directory(folder, error))
        throw core::Error("writing", file.string(), folder.string() + " is not a folder");
    if (access(folder.c_str(), W_OK | X_OK) != 0)
        throw core::Error("writing", file.string(), folder.string() + ": " + std::strerror(errno));
}

void check_writable(const std::filesystem::path& file) {
    check_reachable(file);
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw core::Error("writing", file.string(), error.message());

    // Make a file of a name that nobody has: mkstemp sees to that.
    std::string probe = (folder / ".render2mpeg-XXXXXX").string();
    const int descriptor = mkstemp(probe.data());
    if (descriptor < 0)
        throw core::Error("writing", file.string(),
                          std::string("the folder cannot be written: ") + std::strerror(errno));
    close(descriptor);
    std::filesystem::remove(probe, error);
}

void check_apart(const std::vector<std::filesystem::path>& inputs, const std::vector<std::filesystem::path>& outputs) {
    const auto same = [](const std::filesystem::path& a, const std::filesystem::path& b) {
        std::error_code error;
        if (std::filesystem::equivalent(a, b, error)) return true;
        return std::filesystem::weakly_canonical(a, error) == std::filesystem::weakly_canonical(b, error);
    };
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        if (outputs[i].empty()) continue;
        for (const std::filesystem::path& input : inputs)
            if (!input.empty() && same(outputs[i], input))
                throw core::Error("writing", outputs[i].string(), "it is an input");
        for (std::size_t j = 0; j < i; ++j)
            if (!outputs[j].empty() && same(outputs[i], outputs[j]))
                throw core::Error("writing", outputs[i].string(), "two outputs have this name");
    }
}

std::uint64_t publish(const std::vector<ChunkFile>& chunks, const Film& film, WorkFolder& work,
                      const std::filesystem::path& target) {
    const std::filesystem::path file = work.begin("film" + target.extension().string());
    assemble(chunks, film, file, target);
    verify(file, chunks);
    return give_name(file, target);
}

std::uint64_t give_name(const std::filesystem::path& file, const std::filesystem::path& target) {
    std::error_code error;
    const std::uint64_t bytes = std::filesystem::file_size(file, error);
    if (!error) std::filesystem::rename(file, target, error);
    if (error) throw core::Error("writing", target.string(), error.message());
    return bytes;
}

void clear_away(const std::filesystem::path& output, WorkFolder& work) {
    std::error_code ignored;
    std::filesystem::remove(partial_film_of(output), ignored);
    work.remove();
}

}  // namespace render2mpeg::app
