#include "app/files/completion_marker.h"

#include <fmt/format.h>
#include <sys/xattr.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <system_error>

#include "app/files/checksum.h"
#include "app/files/identity_difference.h"
#include "app/files/text_file.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

constexpr const char* attribute = "user.render2mpeg.film";
/// chosen: file systems keep attributes of 4 KB together; this leaves other programs some.
constexpr std::size_t most_bytes = 3000;

/// Of the identity, and of the files as they are: names, sizes and times of writing.
std::string checksum_of_film(const Products& products, const nlohmann::json& identity) {
    std::string text = json_text(identity);
    for (const std::filesystem::path& file : products.frames) {
        std::error_code error;
        const auto bytes = std::filesystem::file_size(file, error);
        const auto written = std::filesystem::last_write_time(file, error).time_since_epoch().count();
        text += error
                    ? std::string("missing\n")
                    : fmt::format("{}\n{}\n{}\n", file.filename().string(), bytes, static_cast<std::int64_t>(written));
    }
    Checksum sum;
    sum.add(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
    return text_of(sum.value());
}

/// One line of a mark: a file that was made beside the film.
std::string line_of(const std::filesystem::path& file) {
    std::error_code error;
    return "\n" + std::filesystem::weakly_canonical(std::filesystem::absolute(file, error), error).string() + "\n";
}

}  // namespace

void mark_as_whole(const Products& products, const nlohmann::json& identity) {
    EXPECTS(!products.frames.empty());
    std::string mark = checksum_of_film(products, identity);
    for (const std::filesystem::path& file : products.beside) mark += line_of(file);
    if (mark.size() > most_bytes) return;
    const int failure = setxattr(products.frames.front().c_str(), attribute, mark.data(), mark.size(), 0);
    static_cast<void>(failure);  // then nobody will know it
}

bool is_whole(const Products& products, const nlohmann::json& identity) {
    EXPECTS(!products.frames.empty());
    std::string mark(most_bytes, '\0');
    const ssize_t size = getxattr(products.frames.front().c_str(), attribute, mark.data(), mark.size());
    if (size <= 0) return false;
    mark.resize(static_cast<std::size_t>(size));
    return mark.starts_with(checksum_of_film(products, identity)) &&
           std::all_of(products.beside.begin(), products.beside.end(), [&](const std::filesystem::path& file) {
               std::error_code error;
               return mark.find(line_of(file)) != std::string::npos && std::filesystem::exists(file, error);
           });
}

}  // namespace render2mpeg::app
