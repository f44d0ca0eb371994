#pragma once
// The error that users see: one line with file, object and cause.
#include <stdexcept>
#include <string>
#include <string_view>

namespace render2mpeg::core {

/// One line a user can act on: `<doing> <file>[: <object>]: <cause>`. Thrown at the edges only; caught in main.
class Error : public std::runtime_error {
  public:
    /// `doing`: a present participle; `file`: as the user gave it; `cause`: the error and, if possible, its cure.
    Error(std::string_view doing, std::string_view file, std::string_view cause);
    /// The same for one object within the file, e.g. `mesh "Chair", primitive 2`.
    Error(std::string_view doing, std::string_view file, std::string_view object, std::string_view cause);
    /// For errors that concern no file, e.g. an option's value.
    explicit Error(const std::string& line) : std::runtime_error(line) {}
};

/// A broken promise between two parts of this program: never the user's fault.
class ContractViolation : public std::logic_error {
  public:
    ContractViolation(const char* condition, const char* file, int line);
};

}  // namespace render2mpeg::core

/// A contract that stays on in release builds: for calls, not for inner loops.
#define EXPECTS(condition)                                                                              \
    do {                                                                                                \
        if (!(condition)) throw ::render2mpeg::core::ContractViolation(#condition, __FILE__, __LINE__); \
    } while (false)

/// A contract for inner loops: checked in the builds `dev` and `asan`, free in release.
#ifdef RENDER2MPEG_DEBUG_CHECKS
#define EXPECTS_DEBUG(condition) EXPECTS(condition)
#else
#define EXPECTS_DEBUG(condition) static_cast<void>(0)
#endif
