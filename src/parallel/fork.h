#pragma once

/// What the loops of this part share; nobody else includes it.
namespace render2mpeg::parallel {

#ifdef RENDER2MPEG_TELLS_THREAD_SANITIZER
extern "C" void __tsan_acquire(void*);
extern "C" void __tsan_release(void*);
inline void acquire(void* place) {
    __tsan_acquire(place);
}
inline void release(void* place) {
    __tsan_release(place);
}
#else
inline void acquire(void*) {}
inline void release(void*) {}
#endif

/// Tells the thread sanitizer, which does not see into oneTBB, the order that a loop keeps: what came before it, its
/// bodies, and what comes behind it. Nothing else is told, so races between bodies are found.
class Fork {
  public:
    Fork() { release(&begun_); }
    ~Fork() { acquire(&done_); }
    Fork(const Fork&) = delete;
    Fork& operator=(const Fork&) = delete;

    /// Around a body.
    class Prong {
      public:
        explicit Prong(Fork& fork) : fork_(fork) { acquire(&fork_.begun_); }
        ~Prong() { release(&fork_.done_); }
        Prong(const Prong&) = delete;
        Prong& operator=(const Prong&) = delete;

      private:
        Fork& fork_;
    };

  private:
    char begun_ = 0, done_ = 0;
};

}  // namespace render2mpeg::parallel
