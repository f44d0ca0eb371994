#include "scene/gltf/document.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <system_error>

#include "core/error.h"
#include "core/plain_file.h"
#include "core/text.h"
#include "scene/gltf/extensions.h"
#include "scene/gltf/uri.h"
#include "scene/model/wording.h"

namespace render2mpeg::scene::gltf {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t glb_magic = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;  // [glTF2, 4.4]

std::uint32_t little_endian(const std::byte* p) {
    std::uint32_t value = 0;
    for (int k = 3; k >= 0; --k) value = (value << 8) | std::to_integer<std::uint32_t>(p[k]);
    return value;
}

/// The whole of a file; at most `limit` bytes of it. Throws std::invalid_argument with the cause.
std::vector<std::byte> read_file(const fs::path& path,
                                 std::uintmax_t limit = std::numeric_limits<std::uintmax_t>::max()) {
    const std::string name = in_quotes(path.filename().string());
    std::error_code failure;
    if (!fs::exists(path, failure)) throw std::invalid_argument("there is no file " + name);
    if (const std::string why = core::why_no_plain_file(path); !why.empty())
        throw std::invalid_argument("the file " + name + ": " + why);
    const std::uintmax_t size = std::min(fs::file_size(path, failure), limit);
    std::ifstream stream(path, std::ios::binary);
    if (failure || !stream) throw std::invalid_argument("the file " + name + " cannot be opened");
    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (static_cast<std::uintmax_t>(stream.gcount()) != size)
        throw std::invalid_argument("the file " + name + " cannot be read to its end");
    return bytes;
}

/// The same for the scene's own file.
std::vector<std::byte> read_scene_file(const fs::path& path) {
    try {
        return read_file(path);
    } catch (const std::invalid_argument& error) {
        throw core::Error("reading", path.string(), error.what());
    }
}

/// The parser's words on one line, without prefix.
std::string message_of(const nlohmann::json::exception& error) {
    std::string text = error.what();
    if (const std::size_t end = text.find("] "); end != std::string::npos) text = text.substr(end + 2);
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    return text.substr(0, 160);
}

void undo_filter(const Element& extension, std::size_t count, std::size_t stride, std::vector<std::byte>& out) {
    const std::string filter = extension.string("filter", "NONE");
    if (filter == "OCTAHEDRAL") {
        if (stride != 4 && stride != 8) extension.refuse("octahedral values of " + std::to_string(stride) + " bytes");
        meshopt_decodeFilterOct(out.data(), count, stride);
    } else if (filter == "QUATERNION") {
        if (stride != 8) extension.refuse("quaternions of " + std::to_string(stride) + " bytes");
        meshopt_decodeFilterQuat(out.data(), count, stride);
    } else if (filter == "EXPONENTIAL") {
        meshopt_decodeFilterExp(out.data(), count, stride);
    } else if (filter != "NONE") {
        extension.refuse("filter " + in_quotes(filter) + " is none of the extension's");
    }
}

/// Decodes a buffer view. `extension`: its object; `bytes`: the compressed part. Refuses damage and impossible sizes.
/// [EXT_meshopt_compression]
std::vector<std::byte> decode_meshopt(const Element& extension, std::span<const std::byte> bytes) {
    const std::size_t count = extension.required_size("count"), stride = extension.required_size("byteStride");
    const std::string mode = extension.string("mode", "");
    const bool attributes = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES", indices = mode == "INDICES";
    if (!attributes && !triangles && !indices)
        extension.refuse("mode " + in_quotes(mode) + " is none of the extension's");
    const bool fits = attributes ? stride >= 4 && stride <= 256 && stride % 4 == 0 : stride == 2 || stride == 4;
    if (!fits) extension.refuse("has a stride of " + std::to_string(stride) + " bytes");
    if (triangles && count % 3 != 0)
        extension.refuse("has " + std::to_string(count) + " corners, which are no whole number of triangles");
    // Sixteen values of a byte take two bits at least, a triangle and an index one byte.
    const std::size_t most = attributes ? 64 * bytes.size() / stride : (triangles ? 3 : 1) * bytes.size();
    if (count > most)
        extension.refuse("says " + core::counted(count, "element") + ", which " + std::to_string(bytes.size()) +
                         " bytes cannot hold");

    std::vector<std::byte> out(count * stride);
    const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
    int fault = 0;
    if (attributes)
        fault = meshopt_decodeVertexBuffer(out.data(), count, stride, from, bytes.size());
    else if (triangles)
        fault = meshopt_decodeIndexBuffer(out.data(), count, stride, from, bytes.size());
    else
        fault = meshopt_decodeIndexSequence(out.data(), count, stride, from, bytes.size());
    if (fault != 0) extension.refuse("does not decode");
    if (attributes) undo_filter(extension, count, stride, out);
    return out;
}

}  // namespace

std::string singular(const std::string& kind) {
    if (kind == "meshes") return "mesh";
    if (kind == "bufferViews") return "buffer view";
    return kind.substr(0, kind.size() - 1);
}

void Element::refuse(const std::string& cause) const {
    document_->refuse(where_, cause);
}

bool Element::has(const char* key) const {
    return json_->contains(key);
}

const nlohmann::json* Element::find(const char* key) const {
    const auto found = json_->find(key);
    return found == json_->end() ? nullptr : &*found;
}

double Element::number_of(const nlohmann::json& value, const std::string& what) const {
    if (!value.is_number()) refuse(what + " is not a number");
    const double number = value.get<double>();
    // All but transforms end in single precision; transforms must fit, too.
    if (!std::isfinite(number) || !std::isfinite(static_cast<float>(number))) refuse(what + " is too large");
    return number;
}

double Element::number(const char* key, double otherwise) const {
    const nlohmann::json* value = find(key);
    return value == nullptr ? otherwise : number_of(*value, key);
}

bool Element::boolean(const char* key, bool otherwise) const {
    const nlohmann::json* value = find(key);
    if (value == nullptr) return otherwise;
    if (!value->is_boolean()) refuse(std::string(key) + " is neither true nor false");
    return value->get<bool>();
}

std::string Element::string(const char* key, const std::string& otherwise) const {
    const nlohmann::json* value = find(key);
    if (value == nullptr) return otherwise;
    if (!value->is_string()) refuse(std::string(key) + " is not a string");
    return value->get<std::string>();
}

std::size_t Element::size(const char* key, std::size_t otherwise) const {
    const nlohmann::json* value = find(key);
    if (value == nullptr) return otherwise;
    const double number = number_of(*value, key);
    constexpr double limit = 9007199254740992.0;  // 2^53: beyond it JSON numbers are not exact
    if (!(number >= 0 && number < limit) || number != std::floor(number))
        refuse(std::string(key) + " is not a whole number of 0 or more");
    return static_cast<std::size_t>(number);
}

std::size_t Element::required_size(const char* key) const {
    if (!has(key)) refuse(std::string(key) + " is missing");
    return size(key, 0);
}

int Element::index_of(const nlohmann::json& value, const std::string& what, const char* kind) const {
    const double number = number_of(value, what);
    if (!(number >= 0) || number != std::floor(number)) refuse(what + " is not an index");
    const std::size_t count = document_->count(kind);
    if (number >= static_cast<double>(count))
        refuse(what + " refers to " + singular(kind) + " " + value.dump() + ", but there " +
               (count == 1 ? "is " : "are ") + std::to_string(count));
    return static_cast<int>(number);
}

int Element::index(const char* key, const char* kind) const {
    const nlohmann::json* value = find(key);
    return value == nullptr ? -1 : index_of(*value, key, kind);
}

int Element::required_index(const char* key, const char* kind) const {
    if (!has(key)) refuse(std::string(key) + " is missing");
    return index(key, kind);
}

std::vector<int> Element::indices(const char* key, const char* kind) const {
    std::vector<int> result;
    const nlohmann::json* value = find(key);
    if (value == nullptr) return result;
    if (!value->is_array()) refuse(std::string(key) + " is not an array");
    result.reserve(value->size());
    for (const nlohmann::json& entry : *value) result.push_back(index_of(entry, key, kind));
    return result;
}

std::vector<double> Element::numbers(const char* key, std::size_t count) const {
    std::vector<double> result;
    const nlohmann::json* value = find(key);
    if (value == nullptr) return result;
    if (!value->is_array()) refuse(std::string(key) + " is not an array");
    if (count != 0 && value->size() != count)
        refuse(std::string(key) + " has " + core::counted(value->size(), "number") + " instead of " +
               std::to_string(count));
    result.reserve(value->size());
    for (const nlohmann::json& entry : *value) result.push_back(number_of(entry, key));
    return result;
}

std::optional<Element> Element::object(const char* key) const {
    const nlohmann::json* value = find(key);
    if (value == nullptr) return std::nullopt;
    if (!value->is_object()) refuse(std::string(key) + " is not an object");
    return Element(*document_, *value, where_.empty() ? key : where_ + ", " + key);
}

std::vector<Element> Element::objects(const char* key) const {
    std::vector<Element> result;
    const nlohmann::json* value = find(key);
    if (value == nullptr) return result;
    if (!value->is_array()) refuse(std::string(key) + " is not an array");
    for (std::size_t i = 0; i < value->size(); ++i) {
        const std::string name = singular(key) + " " + std::to_string(i);
        if (!(*value)[i].is_object()) refuse(name + " is not an object");
        result.emplace_back(*document_, (*value)[i], where_.empty() ? name : where_ + ", " + name);
    }
    return result;
}

std::optional<Element> Element::extension(const char* name) const {
    const std::optional<Element> extensions = object("extensions");
    if (!extensions || !extensions->has(name)) return std::nullopt;
    const nlohmann::json& value = *extensions->find(name);
    if (!value.is_object()) refuse(std::string(name) + " is not an object");
    return Element(*document_, value, where_.empty() ? name : where_ + ", " + name);
}

std::vector<std::pair<std::string, int>> Element::index_map(const char* key, const char* kind) const {
    std::vector<std::pair<std::string, int>> result;
    const nlohmann::json* value = key == nullptr ? json_ : find(key);
    if (value == nullptr) return result;
    if (!value->is_object()) refuse(std::string(key != nullptr ? key : "it") + " is not an object");
    for (const auto& [name, entry] : value->items()) result.emplace_back(name, index_of(entry, in_quotes(name), kind));
    return result;
}

Document::Document(const fs::path& file, BeforeDecoding before_decoding)

    : file_(file),
      json_(std::make_unique<const nlohmann::json>()),
      files_{file},
      before_decoding_(std::move(before_decoding)) {
    const std::vector<std::byte> bytes = read_scene_file(file);
    if (bytes.empty()) throw core::Error("reading", file.string(), "the file is empty");
    if (bytes.size() >= 4 && little_endian(bytes.data()) == glb_magic)
        read_binary(bytes);
    else
        read_json(bytes, 0, bytes.size());
    check_asset();
    check_extensions();
    read_buffers();
}

Document::~Document() = default;

void Document::refuse(const std::string& where, const std::string& cause) const {
    if (where.empty()) throw core::Error("reading", file_.string(), cause);
    throw core::Error("reading", file_.string(), where, cause);
}

void Document::read_json(const std::vector<std::byte>& bytes, std::size_t first, std::size_t size) {
    const char* text = reinterpret_cast<const char*>(bytes.data()) + first;
    try {
        json_ = std::make_unique<const nlohmann::json>(nlohmann::json::parse(text, text + size));
    } catch (const nlohmann::json::exception& error) {
        const bool has_text =
            std::any_of(text, text + size, [](char c) { return std::isgraph(static_cast<unsigned char>(c)); });
        refuse("", has_text ? "is not JSON: " + message_of(error) : "it is empty, or damaged: it holds no text");
    }
    if (!json_->is_object()) refuse("", "is not a glTF file: its JSON is not an object");
}

void Document::read_binary(const std::vector<std::byte>& bytes) {
    // The header's length may fall short of the file's (padding), never exceed it. [glTF2, 4.4]
    if (bytes.size() < 20)
        refuse("", "is truncated: a binary glTF file has at least 20 bytes, this one " + std::to_string(bytes.size()));
    if (const std::uint32_t version = little_endian(&bytes[4]); version != 2)
        refuse("", "is binary glTF of version " + std::to_string(version) + "; version 2 is read");
    const std::size_t length = little_endian(&bytes[8]);
    if (length > bytes.size())
        refuse("",
               "is truncated: it says " + std::to_string(length) + " bytes and has " + std::to_string(bytes.size()));

    bool has_json = false;
    for (std::size_t at = 12; at + 8 <= length;) {
        const std::size_t size = little_endian(&bytes[at]);
        const std::uint32_t kind = little_endian(&bytes[at + 4]);
        at += 8;
        if (size > length - at)
            refuse("",
                   "is truncated: a chunk of " + std::to_string(size) + " bytes has " + std::to_string(length - at));
        if (!has_json && kind != json_chunk) refuse("", "its first chunk is not JSON");
        if (kind == json_chunk && !has_json) {
            read_json(bytes, at, size);
            has_json = true;
        } else if (kind == binary_chunk && !binary_chunk_) {
            binary_chunk_.emplace(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                  bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
        }
        at += size;
    }
    if (!has_json) refuse("", "has no JSON chunk");
}

void Document::check_asset() const {
    const std::optional<Element> asset = root().object("asset");
    if (!asset) refuse("", "is not a glTF file: it has no asset");
    const std::string minimum = asset->string("minVersion", ""),
                      version = minimum.empty() ? asset->string("version", "") : minimum;
    const bool readable = minimum.empty() ? version.compare(0, 2, "2.") == 0 : minimum == "2.0";
    if (!readable) refuse("asset", "is of glTF version " + in_quotes(version) + "; version 2.0 is read");
}

void Document::check_extensions() {
    const auto names_in = [&](const char* key) {
        std::vector<std::string> names;
        if (!json_->contains(key)) return names;
        const nlohmann::json& list = (*json_)[key];
        if (!list.is_array()) refuse("", std::string(key) + " is not an array");
        for (const nlohmann::json& name : list) {
            if (!name.is_string()) refuse("", std::string(key) + " holds what is not a string");
            names.push_back(name.get<std::string>());
        }
        return names;
    };
    for (const std::string& name : names_in("extensionsRequired"))
        if (!is_read(name)) refuse("", "needs the extension " + in_quotes(name) + ", which is not supported");
    const std::vector<std::string> listed = names_in("extensionsUsed"), carried = extensions_in(*json_);
    std::set<std::string> told;
    for (const std::string& name : listed)
        if (!is_read(name) && told.insert(name).second) notes_.push_back(not_read(name));
    for (const std::string& name : carried) {
        if (std::find(listed.begin(), listed.end(), name) != listed.end()) continue;
        notes_.push_back(is_read(name) ? "uses the extension " + in_quotes(name) + ", which it does not list"
                                       : not_read(name) + " (the file uses it and does not list it)");
    }
}

void Document::read_buffers() {
    const std::vector<Element> buffers = all("buffers");
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        const Element& buffer = buffers[i];
        const std::size_t length = buffer.required_size("byteLength");
        std::vector<std::byte> bytes;
        const std::optional<Element> compressed = buffer.extension("EXT_meshopt_compression");
        if (!buffer.has("uri") && compressed && compressed->boolean("fallback", false)) {
            // A placeholder for decompressed bytes.
            buffers_.emplace_back();
            continue;
        }
        if (buffer.has("uri")) {
            const std::string uri = buffer.string("uri", "");
            try {
                if (std::optional<std::vector<std::byte>> data = bytes_of_data_uri(uri)) {
                    bytes = std::move(*data);
                } else {
                    files_.push_back(path_of_uri(uri, folder()));
                    bytes = read_file(files_.back(), length);
                }
            } catch (const std::invalid_argument& error) {
                buffer.refuse(error.what());
            }
        } else if (i == 0 && binary_chunk_) {
            bytes = std::move(*binary_chunk_);
        } else {
            buffer.refuse("has no URI");
        }
        if (bytes.size() < length)
            buffer.refuse("says " + std::to_string(length) + " bytes and has " + std::to_string(bytes.size()));
        bytes.resize(length);
        buffers_.push_back(std::move(bytes));
    }
}

std::size_t Document::count(const char* kind) const {
    const auto found = json_->find(kind);
    return found != json_->end() && found->is_array() ? found->size() : 0;
}

Element Document::at(const char* kind, int index) const {
    const nlohmann::json& entry = (*json_)[kind][static_cast<std::size_t>(index)];
    const std::string name = singular(kind);
    if (!entry.is_object()) refuse(name + " " + std::to_string(index), "is not an object");
    const auto found = entry.find("name");
    const std::string own = found != entry.end() && found->is_string() ? found->get<std::string>() : "";
    return Element(*this, entry, described(name, static_cast<std::size_t>(index), own));
}

std::vector<Element> Document::all(const char* kind) const {
    if (json_->contains(kind) && !(*json_)[kind].is_array()) refuse("", std::string(kind) + " is not an array");
    std::vector<Element> elements;
    for (std::size_t i = 0; i < count(kind); ++i) elements.push_back(at(kind, static_cast<int>(i)));
    return elements;
}

Document::Bytes Document::part_of_buffer(const Element& view, const std::string& where) const {
    const std::vector<std::byte>& buffer = buffers_[static_cast<std::size_t>(view.required_index("buffer", "buffers"))];
    const std::size_t offset = view.size("byteOffset", 0), length = view.required_size("byteLength"),
                      stride = view.size("byteStride", 0);
    if (offset > buffer.size() || length > buffer.size() - offset)
        refuse(where, view.where() + " (" + std::to_string(length) + " bytes at " + std::to_string(offset) +
                          ") leaves its buffer of " + std::to_string(buffer.size()) + " bytes");
    return {buffer.data() + offset, length, stride};
}

Document::Bytes Document::view(int buffer_view, const std::string& where) const {
    const Element view = at("bufferViews", buffer_view);
    if (const std::optional<Element> compressed = view.extension("EXT_meshopt_compression")) {
        auto known = decoded_.find(buffer_view);
        if (known == decoded_.end()) {
            const Bytes packed = part_of_buffer(*compressed, where);
            before_decoding();
            known = decoded_.emplace(buffer_view, decode_meshopt(*compressed, {packed.first, packed.size})).first;
        }
        return {known->second.data(), known->second.size(), compressed->required_size("byteStride")};
    }
    const Bytes bytes = part_of_buffer(view, where);
    if (bytes.stride != 0 && (bytes.stride < 4 || bytes.stride > 252))
        refuse(where,
               view.where() + " has a stride of " + std::to_string(bytes.stride) + " bytes; it must lie in 4..252");
    return bytes;
}

void Document::before_decoding() const {
    if (!before_decoding_) return;
    std::uintmax_t size = json_->size();
    for (const std::vector<std::byte>& buffer : buffers_) size += buffer.size();
    std::exchange(before_decoding_, {})(size);
}

}  // namespace render2mpeg::scene::gltf
