#include "app/farm/pack.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "app/files/file_io.h"
#include "app/system/program.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

bool is_file(const std::filesystem::path& file) {
    std::error_code error;
    return !file.empty() && std::filesystem::is_regular_file(file, error);
}

/// The folder that both are in.
std::filesystem::path common_folder(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::filesystem::path common;
    for (auto one = a.begin(), other = b.begin(); one != a.end() && other != b.end() && *one == *other; ++one, ++other)
        common /= *one;
    return common;
}

void copy_input(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::error_code error;
    std::filesystem::create_directories(to.parent_path(), error);
    if (!error) std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing, error);
    if (error) throw core::Error("packing", from.string(), error.message());
}

/// Maps an option's value to its value in a pack: the name of a copy, or a full name.
class PackedNames {
  public:
    explicit PackedNames(std::filesystem::path inputs) : inputs_(std::move(inputs)) {}

    std::string of(const std::string& option, const std::string& value) {
        constexpr std::array<std::string_view, 5> outputs{"-o", "--output", "--stats", "--report", "--aov"};
        constexpr std::array<std::string_view, 3> inputs{"--sky", "--audio", "--keyframes"};
        if (std::find(outputs.begin(), outputs.end(), option) != outputs.end()) return full_name(value);
        if (std::find(inputs.begin(), inputs.end(), option) == inputs.end() || !is_file(value)) return value;
        const std::filesystem::path name =
            std::filesystem::path("more") /
            fmt::format("{}_{}", ++copied_, std::filesystem::path(value).filename().string());
        copy_input(value, inputs_ / name);
        return name.string();
    }
    static std::string full_name(const std::string& file) {
        std::error_code error;
        return std::filesystem::absolute(file, error).lexically_normal().string();
    }

  private:
    std::filesystem::path inputs_;
    int copied_ = 0;
};

/// Copies a scene with all its files, their places beside each other kept. Returns the scene's new name.
std::filesystem::path copy_scene(const RenderJob& film, const RenderOptions& options,
                                 const std::filesystem::path& inputs) {
    std::vector<std::filesystem::path> files;
    for (const std::filesystem::path& file : film.animation->files) files.push_back(file);
    for (const scene::ImageSource& image : film.animation->images) files.push_back(image.path);
    if (is_file(options.input)) files.push_back(options.input);
    std::erase_if(files, [&](const std::filesystem::path& file) {
        return !is_file(file) || (options.sky && canonical_of(file) == canonical_of(*options.sky));
    });
    const std::filesystem::path input = canonical_of(options.input);
    std::filesystem::path folder = is_file(input) ? input.parent_path() : input;
    for (const std::filesystem::path& file : files) folder = common_folder(folder, canonical_of(file).parent_path());
    for (const std::filesystem::path& file : files)
        copy_input(file, inputs / "scene" / canonical_of(file).lexically_relative(folder));
    return std::filesystem::path("scene") / input.lexically_relative(folder);
}

}  // namespace

void pack_inputs(FarmPlan& plan, const RenderJob& film, const RenderOptions& options) {
    if (options.light_cache)
        throw core::Error("packing", options.light_cache->string(),
                          "a light file cannot be packed; leave --light-cache out");
    const std::filesystem::path inputs = plan.folder / "inputs";
    std::error_code error;
    std::filesystem::remove_all(inputs, error);
    PackedNames names(inputs);
    std::vector<std::string> words(plan.words.begin(), plan.words.begin() + 2);
    bool named = false;
    for (std::size_t i = 2; i < plan.words.size(); ++i) {
        const std::string& word = plan.words[i];
        const std::string& before = plan.words[i - 1];
        const std::size_t equals = word.find('=');
        if (word.starts_with("--") && equals != std::string::npos)
            words.push_back(word.substr(0, equals + 1) + names.of(word.substr(0, equals), word.substr(equals + 1)));
        else if (i >= 2 && plan.words[i - 2] == "--heatmap")
            words.push_back(PackedNames::full_name(word));
        else if (!named && word == options.input.string() && !before.starts_with("-"))
            named = true, words.push_back(copy_scene(film, options, inputs).string());
        else
            words.push_back(names.of(before, word));
    }
    if (!named) {
        // The scene's name stands behind a flag.
        const auto place = std::find(words.begin() + 2, words.end(), options.input.string());
        if (place == words.end()) throw core::Error("packing", options.input.string(), "it is not in the command line");
        *place = copy_scene(film, options, inputs).string();
    }
    plan.words = words;
    plan.start = inputs;
}

void write_pack(const FarmPlan& plan) {
    const std::filesystem::path archive = std::filesystem::path(plan.folder) += ".tar",
                                beside = std::filesystem::path(archive) += ".unfinished";
    // The same files give the same bytes.
    std::vector<std::string> words{"tar",       "--create",  "--force-local",   "--sort=name",       "--mtime=@0",
                                   "--owner=0", "--group=0", "--numeric-owner", "--mode=u=rwX,go=rX"};
    words.push_back("--file=" + beside.string());
    words.push_back("--directory=" + plan.folder.parent_path().string());
    words.emplace_back("--");
    std::error_code error;
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(plan.folder, error)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with("part_") && name != "log") names.push_back((plan.folder.filename() / name).string());
    }
    std::sort(names.begin(), names.end());
    words.insert(words.end(), names.begin(), names.end());
    const Finished packed = run_program(words, Output::caught);
    if (packed.status == 0) {
        bring_to_disk(beside);
        std::filesystem::rename(beside, archive, error);
    }
    if (packed.status == 0 && !error) return;
    std::filesystem::remove(beside, error);
    throw core::Error("packing", plan.folder.string(),
                      packed.status == 127 ? "there is no program tar"
                                           : "it cannot be written: " + packed.text.substr(0, packed.text.find('\n')));
}

}  // namespace render2mpeg::app
