#include "core/module.h"

#include <dlfcn.h>
#include <sys/auxv.h>

#include <cstdlib>
#include <map>
#include <mutex>
#include <system_error>

#include "core/error.h"

namespace render2mpeg::core {
namespace {

namespace fs = std::filesystem;

std::string loader_message() {
    const char* message = dlerror();
    return message != nullptr ? message : "the loader gives no reason";
}

void* open_module(const std::string& file) {
    const fs::path path = installed_file(file);
    void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) throw Error("opening", path.string(), loader_message());
    return handle;
}

}  // namespace

fs::path program_file(const fs::path& link) {
    std::error_code failure;
    const fs::path linked = fs::read_symlink(link, failure);
    if (!failure) return linked;
    const auto* started = reinterpret_cast<const char*>(getauxval(AT_EXECFN));
    return started != nullptr ? fs::canonical(started, failure) : fs::path();
}

std::vector<fs::path> module_folders() {
    std::vector<fs::path> folders;
    if (const char* wanted = std::getenv("RENDER2MPEG_MODULES"); wanted != nullptr && *wanted != '\0')
        folders.emplace_back(wanted);
    if (const fs::path here = program_file().parent_path(); !here.empty()) {
        folders.push_back(here / "modules");
        folders.push_back((here / RENDER2MPEG_MODULES_FROM_BINARY).lexically_normal());
    }
    folders.emplace_back(RENDER2MPEG_MODULES_INSTALLED);
    return folders;
}

fs::path installed_file(const std::string& name) {
    std::string searched;
    for (const fs::path& folder : module_folders()) {
        std::error_code failure;
        if (fs::exists(folder / name, failure)) return folder / name;
        searched += (searched.empty() ? "" : ", ") + folder.string();
    }
    throw Error("opening", name, "not found in " + searched + "; RENDER2MPEG_MODULES can name its folder");
}

void* module_symbol(const std::string& part, const std::string& symbol) {
    static std::mutex mutex;
    static std::map<std::string, void*> handles;
    const std::string file = "render2mpeg_" + part + "_module.so";

    void* handle = nullptr;
    {
        const std::lock_guard lock(mutex);
        void*& known = handles[part];
        if (known == nullptr) known = open_module(file);
        handle = known;
    }
    void* address = dlsym(handle, symbol.c_str());
    if (address == nullptr) throw Error("opening", file, symbol, "not in this module: it belongs to another version");
    return address;
}

}  // namespace render2mpeg::core
