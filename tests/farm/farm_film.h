#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "support/program.h"

/// A film for farms: eight chunks of ten frames, rendered in a second, and what one run makes of it.
namespace render2mpeg::test {

/// A scene in a folder of its own, and commands on it.
class FarmFilm {
  public:
    /// `more`: options of the film. `gop` frames, of which chunks of some 60 are made.
    explicit FarmFilm(const std::string& more = "", int frames = 240, const std::string& size = "16x16",
                      const std::string& scene = support::travel_scene(80))
        : more_(more), frames_(frames), size_(size) {
        std::ofstream(folder_ / "scene.json") << scene;
    }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
    std::string options() const {
        return " " + path("scene.json") + " --hold --frames 0:" + std::to_string(frames_ - 1) + " --size " + size_ +
               " --samples 1 --gop 30 --overwrite --quiet " + more_ + " ";
    }
    /// `names`: of outputs, as options.
    support::Outcome render(const std::string& names) const {
        return support::run(support::program() + " render --threads 1" + options() + names);
    }
    support::Outcome farm(const std::string& names, const std::string& how) const {
        return support::run(support::program() + " farm --threads 1" + options() + names + " " + how);
    }
    /// Of a plan `film.mpg.farm` and the like.
    std::string part(const std::string& plan, int number) const {
        return support::program() + " part --threads 1 --quiet " + path(plan) + " " + std::to_string(number);
    }
    support::Outcome join(const std::string& plan, const std::string& more = "") const {
        return support::run(support::program() + " join --threads 1 --quiet " + path(plan) + " " + more);
    }
    bool same(const std::string& one, const std::string& other) const {
        const std::string bytes = support::contents(folder_ / one);
        return !bytes.empty() && bytes == support::contents(folder_ / other);
    }
    std::filesystem::path folder() const { return folder_.path(); }

  private:
    support::Folder folder_;
    std::string more_;
    int frames_;
    std::string size_;
};

/// Four chunks, of which the third sees a box that turns, and the others next to nothing.
inline std::string dear_shot_scene() {
    return R"({ "times": "frames", "frames": 240, "exposure": 0,
  "cameras": { "away": { "position": [0, 1, 30], "look_at": [0, 1, 60] },
               "at": { "position": [0, 1.5, 4], "look_at": [0, 0.5, 0] } },
  "shots": [{ "at": 0, "camera": "away" }, { "at": 110, "camera": "at" }, { "at": 170, "camera": "away" }],
  "lights": [{ "kind": "point", "position": [1, 2, 1], "intensity": 9 }],
  "objects": [{ "name": "floor", "shape": "plane", "size": [6, 6] },
              { "name": "box", "shape": "box",
                "keys": [{ "at": 0, "rotate": [0, 0, 0] }, { "at": 240, "rotate": [0, 900, 0] }] }] })";
}

/// Every number of a JSON value to nine digits: sums of sums differ in their last ones.
inline void round_numbers(nlohmann::json& value) {
    if (value.is_number_float()) value = std::round(value.get<double>() * 1e9) / 1e9;
    if (value.is_structured())
        for (nlohmann::json& inner : value) round_numbers(inner);
}

/// Statistics without what another run measures otherwise: times, memory, and the photons that every run needs anew.
inline nlohmann::json lasting_statistics(const std::filesystem::path& file) {
    nlohmann::json s = nlohmann::json::parse(support::contents(file));
    for (const char* key : {"seconds", "passes", "effects", "peak_rss_mib", "command", "output"}) s.erase(key);
    for (const char* key :
         {"photon_rays", "photon_energy", "photon_energy_lost", "calibration_seconds", "sky_seconds", "layer_seconds"})
        s["counts"].erase(key);
    if (s["audit"].is_object()) s["audit"].erase("seconds");
    for (nlohmann::json& frame : s["per_frame"])
        for (const char* time : {"seconds", "seconds_by_stage"}) frame.erase(time);
    round_numbers(s);
    return s;
}

}  // namespace render2mpeg::test
