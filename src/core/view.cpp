#include "core/view.h"

#include <algorithm>
#include <cstddef>

#include "core/error.h"
#include "core/text.h"

namespace render2mpeg::core {

ViewName view_from(const std::string& name) {
    const auto found = std::find(view_names.begin(), view_names.end(), name);
    if (found != view_names.end()) return static_cast<ViewName>(found - view_names.begin());
    std::string all;
    for (const std::string_view known : view_names) all += (all.empty() ? "" : ", ") + std::string(known);
    throw Error("view " + name + ": expected one of " + all + did_you_mean(lower_case(name), view_names));
}

std::string text_of(const View& view) {
    std::string text(view_names[static_cast<std::size_t>(view.name)]);
    if (view.name == ViewName::pq && view.peak != usual_peak)
        return text + ", peak " + std::to_string(static_cast<int>(view.peak)) + " cd/m2";
    if (view.gamma == 1) return text;
    std::string gamma = std::to_string(view.gamma);
    gamma.erase(gamma.find_last_not_of('0') + 1);
    if (gamma.back() == '.') gamma.pop_back();
    return text + ", gamma " + gamma;
}

}  // namespace render2mpeg::core
