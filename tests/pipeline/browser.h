#pragma once
// Pages in a headless browser, and what they say.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "pipeline/fixture.h"

namespace render2mpeg::test {

/// The browser's command; empty: there is none.
inline std::string browser() {
    const auto found = run("command -v chromium || command -v chromium-browser || command -v google-chrome");
    return found.status == 0 ? found.output.substr(0, found.output.find('\n')) : "";
}

/// What a page logs between FOUND and END; the browser is ended then.
inline json said_by_page(const Folder& folder, const std::string& page) {
    const std::string console = path(folder, "console");
    run(browser() +
        " --headless --no-sandbox --disable-gpu --autoplay-policy=no-user-gesture-required --enable-logging=stderr "
        "--user-data-dir=" +
        path(folder, "profile") + " file://" + page + " > /dev/null 2> " + console +
        " & job=$!; for i in $(seq 600); do " + "grep -q FOUND " + console +
        " && break; kill -0 $job || break; sleep 0.1; done; kill $job; wait $job");
    const std::string said = contents(console);
    const std::size_t begin = said.find("FOUND "), end = said.find(" END", begin);
    if (begin == std::string::npos || end == std::string::npos) {
        ADD_FAILURE() << "the browser said nothing: " << said.substr(0, 2000);
        return {};
    }
    return json::parse(said.substr(begin + 6, end - begin - 6));
}

/// Writes a page's line that holds a film: `name` becomes its bytes in base64.
inline void put_film(const std::string& page, const std::string& name, const std::string& film) {
    run("{ printf '<script>const " + name + " = \"'; base64 -w 0 " + film + "; printf '\"</script>'; } >> " + page);
}

}  // namespace render2mpeg::test
