#include "scene/gltf/element.h"

#include <cmath>

#include "scene/gltf/document.h"
#include "scene/model/wording.h"

namespace render2mpeg::scene::gltf {

std::string singular(const std::string& kind) {
    if (kind == "meshes") return "mesh";
    if (kind == "bufferViews") return "buffer view";
    return kind.substr(0, kind.size() - 1);
}

void Element::refuse(const std::string& cause) const {
    document_->refuse(where_, cause);
}

const nlohmann::json* Element::find(const char* key) const {
    const auto found = json_->find(key);
    return found == json_->end() ? nullptr : &*found;
}

double Element::number_of(const nlohmann::json& value, const std::string& what) const {
    if (!value.is_number()) refuse(what + " is not a number");
    const double number = value.get<double>();
    // Single precision is what all numbers end in, except transforms; they too must fit.
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
        refuse(std::string(key) + " has " + counted(value->size(), "number") + " instead of " + std::to_string(count));
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
    if (!value->is_object()) refuse(std::string(key) + " is not an object");
    for (const auto& [name, entry] : value->items()) result.emplace_back(name, index_of(entry, in_quotes(name), kind));
    return result;
}

}  // namespace render2mpeg::scene::gltf
