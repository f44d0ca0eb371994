#pragma once
// Reads the JSON part of glTF, every type and index checked.
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Reading glTF: the JSON part with every type and index checked as it is read (docs/decisions.md#own-gltf-reader says
/// why there is no library between).
namespace render2mpeg::scene::gltf {

class Document;

/// The word for one of a top-level array, for messages: "bufferViews" to "buffer view".
std::string singular(const std::string& kind);

/// A JSON object of the document that knows its name for messages. Every function throws core::Error if a property has
/// the wrong type, is not finite or refers to what is not there.
class Element {
  public:
    Element(const Document& document, const nlohmann::json& json, std::string where)
        : document_(&document), json_(&json), where_(std::move(where)) {}

    const std::string& where() const { return where_; }
    /// The same element, named after what refers to it in messages: `mesh 3, POSITION (accessor 7)`.
    Element seen_from(const std::string& user) const { return Element(*document_, *json_, user + " (" + where_ + ")"); }
    bool has(const char* key) const { return json_->contains(key); }
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
    /// Exactly `count` numbers, or none at all where absent; count 0: any number of them.
    std::vector<double> numbers(const char* key, std::size_t count) const;

    std::optional<Element> object(const char* key) const;
    std::vector<Element> objects(const char* key) const;  ///< an array of objects; empty where absent
    /// The object of one extension of this one.
    std::optional<Element> extension(const char* name) const;
    /// Name and value of each property, in the order of their names, that is an index into `kind`.
    std::vector<std::pair<std::string, int>> index_map(const char* key, const char* kind) const;

  private:
    const nlohmann::json* find(const char* key) const;
    double number_of(const nlohmann::json& value, const std::string& what) const;
    int index_of(const nlohmann::json& value, const std::string& what, const char* kind) const;

    const Document* document_;
    const nlohmann::json* json_;
    std::string where_;
};

}  // namespace render2mpeg::scene::gltf
