#pragma once
// Film grain as a look.
#include <array>
#include <cstdint>

#include "core/picture.h"
#include "core/plane.h"

namespace render2mpeg::core {

/// Sensitivities of films that have grain here.
inline constexpr int least_iso = 50, most_iso = 6400;

/// Grain of a film of 35 mm as pictures of some height show it: noise of luma by the boolean model of grains
/// [Newson2017], which are much smaller than pixels (docs/model/display.md#film-grain).
class FilmGrain {
  public:
    /// `iso`: least_iso..most_iso; `height`: rows of the picture, > 0.
    FilmGrain(int iso, int height);

    /// Standard deviation of grain, code values, where luma is this; 0 at black and white, and beyond.
    float deviation(float luma) const;

    /// Standard deviation of the blur over a pixel and the film's clumps, pixels: grain at a distance d has the
    /// correlation exp(-d^2 / (4 spot^2)).
    double spot() const { return spot_; }

    /// Grain of a frame of the film, with a standard deviation of 1.
    Plane<float> noise(int width, int height, std::int64_t frame) const;

  private:
    static constexpr int steps = 219;           ///< code values from black to white
    std::array<float, steps + 1> deviation_{};  ///< by luma from 16
    double spot_;
};

/// Adds the grain of the picture's number to its luma, unrounded where that is there. `iso` 0: none.
void add_grain(Picture& picture, int iso);
/// The inverse, but where grain met black or white: those pixels keep some of it.
void take_grain(Picture& picture, int iso);

}  // namespace render2mpeg::core
