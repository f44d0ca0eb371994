#include "app/files/tar_file.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "app/files/disk.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

constexpr std::size_t block = 512;

/// A header block [POSIX, pax, ustar interchange format].
std::array<char, block> header_of(const std::string& name, std::uint64_t bytes, bool runs) {
    std::array<char, block> header{};
    const auto put = [&](std::size_t at, const std::string& text) {
        std::copy(text.begin(), text.end(), header.begin() + static_cast<std::ptrdiff_t>(at));
    };
    // What does not fit into the name goes before it, cut at a slash.
    std::string last = name, before;
    if (last.size() > 100) {
        const std::size_t cut = name.find('/', name.size() - 101);
        if (cut == std::string::npos || cut > 155) throw core::Error("packing", name, "its name is too long");
        before = name.substr(0, cut);
        last = name.substr(cut + 1);
    }
    if (bytes >= (std::uint64_t{1} << 33)) throw core::Error("packing", name, "it has 8 GiB or more");
    put(0, last);
    put(100, runs ? "0000755" : "0000644");
    put(108, "0000000");
    put(116, "0000000");
    put(124, fmt::format("{:011o}", bytes));
    put(136, "00000000000");
    put(148, "        ");
    put(156, "0");
    put(257, "ustar");
    put(263, "00");
    put(345, before);
    unsigned sum = 0;
    for (const char c : header) sum += static_cast<unsigned char>(c);
    put(148, fmt::format("{:06o}", sum));
    header[154] = '\0';
    header[155] = ' ';
    return header;
}

bool may_run(const std::filesystem::path& file) {
    struct stat there {};
    return stat(file.c_str(), &there) == 0 && (there.st_mode & S_IXUSR) != 0;
}

}  // namespace

void write_tar(const std::filesystem::path& archive, const std::filesystem::path& folder,
               const std::vector<std::filesystem::path>& files) {
    const std::filesystem::path beside = std::filesystem::path(archive) += ".unfinished";
    std::ofstream to(beside, std::ios::binary | std::ios::trunc);
    for (const std::filesystem::path& file : files) {
        std::error_code error;
        const std::uint64_t bytes = std::filesystem::file_size(file, error);
        std::ifstream from(file, std::ios::binary);
        if (error || !from) throw core::Error("packing", file.string(), "it cannot be read");
        const auto header = header_of(file.lexically_relative(folder).string(), bytes, may_run(file));
        to.write(header.data(), block);
        if (bytes > 0) to << from.rdbuf();
        const std::string padding((block - bytes % block) % block, '\0');
        to << padding;
    }
    const std::string end(2 * block, '\0');
    to << end;
    to.close();
    std::error_code error;
    if (to) {
        bring_to_disk(beside);
        std::filesystem::rename(beside, archive, error);
    }
    if (!to || error) {
        std::filesystem::remove(beside, error);
        throw core::Error("writing", archive.string(), "it cannot be written; is the disk full?");
    }
}

}  // namespace render2mpeg::app
