#pragma once
// Mistakes on the command line.
#include "core/error.h"

namespace render2mpeg::app {

/// A command line that cannot be meant, whatever the files hold: exit status 2.
class UsageError : public core::Error {
  public:
    using core::Error::Error;
};

/// Reports the errors of a check as usage errors, since the command line asked for the refused setting.
template <class Check>
void refuse_as_usage(const Check& check) {
    try {
        check();
    } catch (const core::Error& error) {
        throw UsageError(error.what());
    }
}

/// A part of a film that cannot be made here, however often it is tried: exit status 3.
class Refusal : public core::Error {
  public:
    using core::Error::Error;
};

}  // namespace render2mpeg::app
