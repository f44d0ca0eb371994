#pragma once
// Opens modules on demand, since the libraries behind them are slow to start.
#include <filesystem>
#include <string>
#include <vector>

/// Parts of the program that are opened on demand, because the outside libraries behind them are dear to start
/// (libavformat costs 135 shared libraries, OpenImageIO 261). A module is built by render2mpeg_module()
/// (cmake/Render2MpegTarget.cmake), links those libraries itself, and is reached through one function with C linkage
/// that hands out an interface.
namespace render2mpeg::core {

/// The file that this process runs, without links; empty where the system does not tell. `link` is the system's link to
/// it; where that cannot be read (no /proc), the name that the process was started by counts, as seen from this folder.
std::filesystem::path program_file(const std::filesystem::path& link = "/proc/self/exe");

/// The folders that are searched for modules, in order: $RENDER2MPEG_MODULES if set, `modules` beside the executable
/// (the build folder), the installed place relative to the executable, the installed place as configured.
std::vector<std::filesystem::path> module_folders();

/// The first file, or folder, of this name in one of these. Throws Error where there is none.
std::filesystem::path installed_file(const std::string& name);

/// Address of the function `symbol` of the file render2mpeg_<part>_module.so. The file is opened at the first call and
/// stays open until the program ends. Safe to call from any thread. Throws Error if the file is missing, cannot be
/// opened (a library it needs is missing: the loader's own words are kept) or lacks the function.
void* module_symbol(const std::string& part, const std::string& symbol);

/// The same, typed: `module_function<const Backend*()>("av", "render2mpeg_av_backend")`. Exceptions that derive from
/// Error or the standard ones pass through the call unharmed.
template <class Function>
Function* module_function(const std::string& part, const std::string& symbol) {
    return reinterpret_cast<Function*>(module_symbol(part, symbol));
}

}  // namespace render2mpeg::core
