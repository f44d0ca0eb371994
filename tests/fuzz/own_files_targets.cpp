#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "app/farm/farm_plan.h"
#include "app/files/file_io.h"
#include "app/files/light_file.h"
#include "app/files/work_folder.h"
#include "core/error.h"
#include "encoder/av/inspect.h"
#include "fuzz/input.h"
#include "fuzz/targets.h"

#include <nlohmann/json.hpp>

namespace render2mpeg::fuzz {

bool plan(Input input) {
    const std::string text(input.begin(), input.end());
    // All that look at the file read it alike.
    const nlohmann::json value = app::parsed_json(text);
    if (!value.is_discarded() && !app::difference_of(value, app::parsed_json(app::json_text(value))).empty())
        throw std::logic_error("what is written is not read again");
    const std::filesystem::path file = input_file().write("plan.json", input);
    try {
        const app::FarmPlan plan = app::read_plan(file);
        std::int64_t chunks = 0;
        for (const app::FilmPart& part : plan.parts) {
            if (plan.folder_of(part).parent_path() != file.parent_path())
                throw std::logic_error("a part lies elsewhere");
            chunks += static_cast<std::int64_t>(part.chunks.count());
            static_cast<void>(plan.is_made(part));
        }
        if (static_cast<std::size_t>(chunks) != plan.parts.back().chunks.last + 1) throw std::logic_error("a gap");
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

bool light(Input input) {
    // The first line is the identity that the reader has.
    const std::string_view text(reinterpret_cast<const char*>(input.data()), input.size());
    const std::size_t line = std::min(text.find('\n'), text.size());
    const nlohmann::json identity = app::parsed_json(text.substr(0, line));
    if (identity.is_discarded()) return false;
    const std::filesystem::path file =
        input_file().write("film.light", input.subspan(std::min(line + 1, input.size())));
    try {
        app::LightFile light(file, identity);
        const app::LightExtent before = light.extent();
        const std::size_t known = light.known(before).size();
        if (known > before.bytes) throw std::logic_error("light from nowhere");
        const std::vector<std::byte> more(144);
        light.add(more);
        if (light.known(light.extent()).size() != known + more.size()) throw std::logic_error("light is lost");
        return before.bytes > 0;
    } catch (const core::Error&) {
        return false;
    }
}

bool film(Input input) {
    const std::filesystem::path file = input_file().write("film", input);
    try {
        return !av::inspect(file).pictures.empty();
    } catch (const core::Error&) {
        return false;
    }
}

}  // namespace render2mpeg::fuzz
