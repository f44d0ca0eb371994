#pragma once
// Attempts several things; the first error is thrown at the end.
#include <exception>
#include <utility>

namespace render2mpeg::app {

class ErrorCollector {
  public:
    /// Returns whether the step did not throw.
    template <class Step>
    bool attempt(Step&& step) {
        try {
            std::forward<Step>(step)();
            return true;
        } catch (const std::exception&) {
            if (!first_) first_ = std::current_exception();
            return false;
        }
    }
    void rethrow() const {
        if (first_) std::rethrow_exception(first_);
    }

  private:
    std::exception_ptr first_;
};

}  // namespace render2mpeg::app
