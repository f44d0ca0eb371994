#pragma once

#include <filesystem>

#include "core/error.h"

namespace render2mpeg::app {

/// Another run holds the output.
class OutputInUse : public core::Error {
  public:
    using core::Error::Error;
};

/// Excludes other runs from an output while it lives. The system releases it with the process, however that ends.
class OutputLock {
  public:
    /// Locks `file`, which is made where there is none, in a folder that is made likewise. `output` is for messages.
    /// Throws OutputInUse where another run holds it, naming that run's process, and core::Error where it is a link or
    /// has another name besides: what that leads to may be anybody's. Waits for 0.2 s at most.
    OutputLock(const std::filesystem::path& file, const std::filesystem::path& output);
    ~OutputLock();
    OutputLock(const OutputLock&) = delete;
    OutputLock& operator=(const OutputLock&) = delete;

    /// Throws as the constructor does, and changes nothing.
    static void check(const std::filesystem::path& file, const std::filesystem::path& output);

  private:
    int descriptor_ = -1;
};

}  // namespace render2mpeg::app
