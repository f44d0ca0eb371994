#pragma once
// Opens modules on demand, since the libraries behind them are slow to start.
#include <filesystem>
#include <string>
#include <vector>

/// Modules are opened on demand, since their libraries are slow to start (libavformat costs 135 shared libraries,
/// OpenImageIO 261). render2mpeg_module() (cmake/Render2MpegTarget.cmake) builds one; a function with C linkage hands
/// out its interface.
namespace render2mpeg::core {

/// This process's program, without links, by `link`, else by the name that it was started by; empty if unknown.
std::filesystem::path program_file(const std::filesystem::path& link = "/proc/self/exe");

/// Folders of modules, in order: $RENDER2MPEG_MODULES, `modules` beside the program (build folder), the installed place
/// relative to it, the configured one.
std::vector<std::filesystem::path> module_folders();

/// The first file, or folder, of this name in one of these. Throws Error where there is none.
std::filesystem::path installed_file(const std::string& name);

/// Address of `symbol` in render2mpeg_<part>_module.so, which is opened once and stays open. Thread-safe. Throws Error
/// for a missing file, library or function.
void* module_symbol(const std::string& part, const std::string& symbol);

/// The same, typed: `module_function<const Backend*()>("av", "render2mpeg_av_backend")`. Exceptions pass through.
template <class Function>
Function* module_function(const std::string& part, const std::string& symbol) {
    return reinterpret_cast<Function*>(module_symbol(part, symbol));
}

}  // namespace render2mpeg::core
