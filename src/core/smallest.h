#pragma once

namespace render2mpeg::core {

/// The N values with the smallest keys of all that it is shown, smallest first; of equal keys the first ones shown.
template <class T, int N, class Key = float>
class Smallest {
  public:
    /// False: N others have keys that are no larger.
    bool add(const T& value, Key key) {
        int place = count_;
        while (place > 0 && key < keys_[place - 1]) --place;
        if (place == N) return false;
        if (count_ < N) ++count_;
        for (int i = count_ - 1; i > place; --i) {
            keys_[i] = keys_[i - 1];
            values_[i] = values_[i - 1];
        }
        keys_[place] = key;
        values_[place] = value;
        return true;
    }
    /// Drops values, but for the first one, whose keys are above `limit`.
    void drop_above(Key limit) {
        while (count_ > 1 && keys_[count_ - 1] > limit) --count_;
    }

    int size() const { return count_; }
    const T& operator[](int i) const { return values_[i]; }
    Key key(int i) const { return keys_[i]; }
    const T* begin() const { return values_; }
    const T* end() const { return values_ + count_; }

  private:
    T values_[N];
    Key keys_[N];
    int count_ = 0;
};

}  // namespace render2mpeg::core
