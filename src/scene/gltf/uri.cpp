#include "scene/gltf/uri.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "scene/model/wording.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/// %41 to A; stray percent signs stay, as many exporters write them.
std::string percent_decoded(std::string_view text) {
    std::string decoded;
    decoded.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        const int high = text[i] == '%' && i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
        const int low = high >= 0 ? hex_digit(text[i + 2]) : -1;
        if (low < 0) {
            decoded += text[i];
            continue;
        }
        decoded += static_cast<char>(high * 16 + low);
        i += 2;
    }
    return decoded;
}

std::array<int, 256> base64_values() {
    std::array<int, 256> values;
    values.fill(-1);
    const std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < alphabet.size(); ++i)
        values[static_cast<unsigned char>(alphabet[i])] = static_cast<int>(i);
    values['-'] = 62;  // the alphabet for URLs [RFC4648, 5]
    values['_'] = 63;
    return values;
}

std::vector<std::byte> base64_decoded(std::string_view text) {
    static const std::array<int, 256> values = base64_values();
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::vector<std::byte> bytes;
    bytes.reserve(text.size() * 3 / 4);
    unsigned int held = 0;
    int bits = 0;
    for (const char c : text) {
        const int value = values[static_cast<unsigned char>(c)];
        if (value < 0) throw std::invalid_argument("its base64 data has a character that is not base64");
        held = (held << 6) | static_cast<unsigned int>(value);
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        bytes.push_back(static_cast<std::byte>((held >> bits) & 0xff));
    }
    // One character alone holds less than a byte.
    if (bits == 6) throw std::invalid_argument("its base64 data is truncated");
    return bytes;
}

/// Whether a URI is absolute; a drive letter ("C:") counts.
bool has_scheme(const std::string& uri) {
    const std::size_t colon = uri.find(':');
    if (colon == std::string::npos || colon == 0 || !std::isalpha(static_cast<unsigned char>(uri[0]))) return false;
    return std::all_of(uri.begin(), uri.begin() + static_cast<std::ptrdiff_t>(colon),
                       [](unsigned char c) { return std::isalnum(c) || c == '+' || c == '-' || c == '.'; });
}

/// Whether `path` is `folder` or lies below it; both canonical.
bool lies_within(const fs::path& path, const fs::path& folder) {
    const auto [in_folder, in_path] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
    static_cast<void>(in_path);
    return in_folder == folder.end();
}

}  // namespace

std::optional<std::vector<std::byte>> bytes_of_data_uri(const std::string& uri) {
    if (uri.compare(0, 5, "data:") != 0) return std::nullopt;
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos) throw std::invalid_argument("its data: URI has no comma");
    const std::string_view head(uri.data(), comma), body(uri.data() + comma + 1, uri.size() - comma - 1);
    constexpr std::string_view base64 = ";base64";
    if (head.size() >= base64.size() && head.substr(head.size() - base64.size()) == base64) {
        if (body.find('%') == std::string_view::npos) return base64_decoded(body);
        return base64_decoded(percent_decoded(body));
    }
    const std::string text = percent_decoded(body);
    const std::byte* first = reinterpret_cast<const std::byte*>(text.data());
    return std::vector<std::byte>(first, first + text.size());
}

fs::path path_of_uri(const std::string& uri, const fs::path& folder) {
    // Refuse by its words all but relative paths.
    const std::string shown = in_quotes(uri);
    if (uri.empty()) throw std::invalid_argument("its URI is empty");
    if (has_scheme(uri))
        throw std::invalid_argument("URI " + shown +
                                    " is not a relative path; only files in the scene's folder are read");
    const std::string decoded = percent_decoded(uri);
    if (decoded.find('\0') != std::string::npos) throw std::invalid_argument("URI " + shown + " has a zero byte");
    if (decoded[0] == '/' || decoded[0] == '\\' || has_scheme(decoded))
        throw std::invalid_argument("URI " + shown + " is an absolute path; only files in the scene's folder are read");
    for (std::size_t at = 0; at <= decoded.size();) {
        const std::size_t end = std::min(decoded.find_first_of("/\\", at), decoded.size());
        if (decoded.compare(at, end - at, "..") == 0)
            throw std::invalid_argument("URI " + shown + " leaves the scene's folder");
        at = end + 1;
    }

    // Refuse by its target, since links can lead anywhere.
    const fs::path base = folder.empty() ? fs::path(".") : folder;
    const fs::path path = base / fs::path(decoded);
    std::error_code failure;
    const fs::path real = fs::weakly_canonical(path, failure), real_base = fs::weakly_canonical(base, failure);
    if (failure || !lies_within(real, real_base))
        throw std::invalid_argument("URI " + shown + " leaves the scene's folder");
    return path;
}

}  // namespace render2mpeg::scene
