#pragma once
#include <string>

#include "app/loop/run_statistics.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// `encode`: frames and motion of any renderer to a film. Exit status: 0, or 130 after an interruption.
int encode(const EncodeOptions& options, const std::string& command);

/// `info`: prints how a film's pictures are coded. Exit status: 1 where pictures are damaged.
int info(const InfoOptions& options);

/// Output of info(): the damage (may be empty), '\0', and the tables or JSON.
std::string info_of(const InfoOptions& options);

/// `render`. Exit status: 0, or 130 after an interruption. `rendered` is filled unless null.
int render(const RenderOptions& options, const std::string& command, Rendered* rendered = nullptr);

int plan(const RenderOptions& options);

/// `watch`: a draft of the film, and a new one whenever its files change, until the player is closed or an interrupt.
int watch(const RenderOptions& options, const std::string& command);

}  // namespace render2mpeg::app
