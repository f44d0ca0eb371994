#pragma once
// Does several things though some fail; the first error is told at the end.
#include <exception>
#include <utility>

namespace render2mpeg::app {

/// Things to be done whatever becomes of the others; the first that fails is told at the end.
class ErrorCollector {
  public:
    template <class Step>
    void attempt(Step&& step) {
        try {
            std::forward<Step>(step)();
        } catch (const std::exception&) {
            if (!first_) first_ = std::current_exception();
        }
    }
    /// Throws what the first failure threw, if there is one.
    void rethrow() const {
        if (first_) std::rethrow_exception(first_);
    }

  private:
    std::exception_ptr first_;
};

}  // namespace render2mpeg::app
