#pragma once
// A glTF file: its JSON and its buffers.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace render2mpeg::scene::gltf {

class Document;

/// Singular for messages: "bufferViews" to "buffer view".
std::string singular(const std::string& kind);

/// JSON object with its name for messages. Throws core::Error for wrong types, non-finite numbers and dangling indices.
class Element {
  public:
    Element(const Document& document, const nlohmann::json& json, std::string where)
        : document_(&document), json_(&json), where_(std::move(where)) {}

    const std::string& where() const { return where_; }
    /// The same element, named by its user: `mesh 3, POSITION (accessor 7)`.
    Element seen_from(const std::string& user) const { return Element(*document_, *json_, user + " (" + where_ + ")"); }
    bool has(const char* key) const;
    [[noreturn]] void refuse(const std::string& cause) const;

    double number(const char* key, double otherwise) const;
    bool boolean(const char* key, bool otherwise) const;
    std::string string(const char* key, const std::string& otherwise) const;
    /// A count or offset: 0 <= value < 2^53.
    std::size_t size(const char* key, std::size_t otherwise) const;
    std::size_t required_size(const char* key) const;
    /// An index into the top-level array `kind` ("meshes"); -1 where absent.
    int index(const char* key, const char* kind) const;
    int required_index(const char* key, const char* kind) const;
    std::vector<int> indices(const char* key, const char* kind) const;
    /// `count` numbers (0: any), none where absent.
    std::vector<double> numbers(const char* key, std::size_t count) const;

    std::optional<Element> object(const char* key) const;
    std::vector<Element> objects(const char* key) const;  ///< an array of objects; empty where absent
    std::optional<Element> extension(const char* name) const;
    /// Properties that are indices into `kind`, sorted by name.
    std::vector<std::pair<std::string, int>> index_map(const char* key, const char* kind) const;

  private:
    const nlohmann::json* find(const char* key) const;
    double number_of(const nlohmann::json& value, const std::string& what) const;
    int index_of(const nlohmann::json& value, const std::string& what, const char* kind) const;

    const Document* document_;
    const nlohmann::json* json_;
    std::string where_;
};

/// Called with the bytes of all files before an outside decoder runs; may throw.
using BeforeDecoding = std::function<void(std::uintmax_t bytes)>;

/// A whole glTF file: its JSON, and the bytes of its buffers. [glTF2]
class Document {
  public:
    /// Reads a .gltf or .glb file with its buffers. Throws core::Error for other versions, truncation, or a missing
    /// extension.
    explicit Document(const std::filesystem::path& file, BeforeDecoding before_decoding = {});
    ~Document();

    const std::filesystem::path& file() const { return file_; }
    std::filesystem::path folder() const { return file_.parent_path(); }
    Element root() const { return Element(*this, *json_, ""); }
    std::size_t count(const char* kind) const;
    Element at(const char* kind, int index) const;
    std::vector<Element> all(const char* kind) const;
    [[noreturn]] void refuse(const std::string& where, const std::string& cause) const;

    struct Bytes {
        const std::byte* first = nullptr;
        std::size_t size = 0;
        std::size_t stride = 0;  ///< 0: tightly packed
    };
    Bytes view(int buffer_view, const std::string& where) const;
    void before_decoding() const;

    /// Every file that was read, itself first.
    const std::vector<std::filesystem::path>& files() const { return files_; }
    /// Notes on ignored parts.
    const std::vector<std::string>& notes() const { return notes_; }

  private:
    void read_json(const std::vector<std::byte>& bytes, std::size_t first, std::size_t size);
    void read_binary(const std::vector<std::byte>& bytes);
    void check_asset() const;
    void check_extensions();
    void read_buffers();
    Bytes part_of_buffer(const Element& view, const std::string& where) const;

    std::filesystem::path file_;
    std::unique_ptr<const nlohmann::json> json_;
    std::optional<std::vector<std::byte>> binary_chunk_;
    std::vector<std::vector<std::byte>> buffers_;
    std::vector<std::filesystem::path> files_;
    std::vector<std::string> notes_;
    mutable BeforeDecoding before_decoding_;                 ///< empty: was called, or not requested
    mutable std::map<int, std::vector<std::byte>> decoded_;  ///< compressed buffer views that were asked for
};

}  // namespace render2mpeg::scene::gltf
