#include "app/publish.h"

#include <fstream>
#include <system_error>

#include "core/error.h"

namespace render2mpeg::app {

void check_writable(const std::filesystem::path& file) {
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw core::Error("writing", file.string(), error.message());
    if (std::filesystem::is_directory(file)) throw core::Error("writing", file.string(), "it is a folder");
    const std::filesystem::path probe = folder / (file.filename().string() + ".probe");
    if (!std::ofstream(probe)) throw core::Error("writing", file.string(), "the folder cannot be written");
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

std::uint64_t publish(const std::vector<ChunkFile>& chunks, const Film& film, const WorkFolder& work,
                      const std::filesystem::path& target) {
    const std::filesystem::path file = work.path("film" + target.extension().string());
    assemble(chunks, film, file, target);
    verify(file, chunks);
    const std::uint64_t bytes = std::filesystem::file_size(file);
    std::error_code error;
    std::filesystem::rename(file, target, error);
    if (error) throw core::Error("writing", target.string(), error.message());
    return bytes;
}

}  // namespace render2mpeg::app
