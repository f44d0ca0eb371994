#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/fixture.h"

/// Reports as a browser shows them, at a phone's and a desktop's width.
namespace render2mpeg::test {
namespace {

constexpr int phone = 390, desktop = 1280;

/// The browser's command; empty: there is none.
std::string browser() {
    const auto found = run("command -v chromium || command -v chromium-browser || command -v google-chrome");
    return found.status == 0 ? found.output.substr(0, found.output.find('\n')) : "";
}

/// Looks at the page from within: whether anything is wider than the window, whether pictures are there, and what
/// moving a slider does. Says it to the page around it.
constexpr const char* probe = R"(<script>
addEventListener('load', () => {
  const at = (s) => getComputedStyle(s.closest('figure').querySelector('.upon img + img')).clipPath;
  const images = [...document.images].map((i) => i.complete && i.naturalWidth > 0);
  const choice = document.querySelector('input.choice'), taken = document.querySelector('.answer .taken'), said = () =>
    document.querySelector('.said').textContent + document.querySelector('.seen').textContent;
  const begins = choice && {picture: choice.closest('figure').querySelector('.upon img').src, said: said(), at: choice.value,
                            isTaken: taken.classList.contains('seen'), wide: choice.getBoundingClientRect().width};
  if (choice) { choice.value = choice.value === '0' ? 1 : 0; choice.dispatchEvent(new Event('input', {bubbles: true})); }
  const goesOn = choice && {picture: choice.closest('figure').querySelector('.upon img').src, said: said(),
                            isTaken: taken.classList.contains('seen')};
  const sliders = [...document.querySelectorAll('input[type=range]:not(.choice)')].map((s) => {
    const before = at(s);
    s.value = 20;
    s.dispatchEvent(new Event('input', {bubbles: true}));
    return {before, after: at(s), wide: s.getBoundingClientRect().width};
  });
  const outside = [...document.querySelectorAll('body *')].filter(
    (e) => !e.closest('.wide') && e.getBoundingClientRect().right > innerWidth + 0.5).map((e) => e.tagName);
  const broken = /\[object|undefined|NaN|Infinity/.exec(document.querySelector('main').textContent);
  parent.postMessage({width: innerWidth, broken: broken && broken[0], across: document.documentElement.scrollWidth, sliders, images, outside, begins, goesOn,
                      charts: document.querySelectorAll('svg').length}, '*');
});
</script>)";

/// What a page says in the attribute `data-found` of its body.
std::string found_on(const Folder& folder, const std::string& html, std::string& console) {
    const auto outcome =
        run(browser() +
            " --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1800,900"
            " --enable-logging=stderr --virtual-time-budget=3000 --user-data-dir=" +
            path(folder, "profile") + " --dump-dom file://" + path(folder, html) + " 2> " + path(folder, "console"));
    for (const std::string& log = contents(folder / "console"); const char* word : {":CONSOLE", "Uncaught"})
        if (log.find(word) != std::string::npos) console += log;
    std::string found = outcome.output;
    const std::size_t begin = found.find("data-found=\"");
    if (begin == std::string::npos) {
        ADD_FAILURE() << "the browser said nothing: " << outcome.output.substr(0, 2000);
        return "[]";
    }
    found = found.substr(begin + 12, found.find('"', begin + 12) - begin - 12);
    for (std::size_t at = 0; (at = found.find("&quot;", at)) != std::string::npos;) found.replace(at, 6, "\"");
    return found;
}

/// What a page says of itself at both widths; pages are shown in frames, since a window is never as narrow as a phone.
std::vector<json> looked_at(const Folder& folder, const std::string& html, std::string& console) {
    std::string page = contents(folder / html);
    page.insert(page.find("</head>"), probe);
    std::ofstream(folder / "probed.html") << page;
    std::ofstream(folder / "around.html")
        << "<!DOCTYPE html><html><body><script>const all = [];\n"
           "addEventListener('message', (m) => { all.push(m.data);\n"
           "  document.body.setAttribute('data-found', JSON.stringify(all)); });</script>\n"
        << "<iframe src=\"probed.html\" width=\"" << phone << "\" height=\"800\" style=\"border:0\"></iframe>\n"
        << "<iframe src=\"probed.html\" width=\"" << desktop << "\" height=\"800\" style=\"border:0\"></iframe>\n"
        << "</body></html>\n";
    return json::parse(found_on(folder, "around.html", console)).get<std::vector<json>>();
}

/// Expects a page to fit both widths and its sliders to work.
void expect_sound(const Folder& folder, const std::string& html, std::size_t sliders) {
    std::string console;
    const std::vector<json> found = looked_at(folder, html, console);
    EXPECT_EQ(console, "");
    ASSERT_EQ(found.size(), 2u);
    std::vector<int> widths;
    for (const json& look : found) {
        widths.push_back(look.at("width").get<int>());
        EXPECT_LE(look.at("across"), look.at("width")) << html << ": nothing scrolls sideways as a whole";
        EXPECT_EQ(look.at("outside"), json::array()) << html << " at " << look.at("width");
        EXPECT_GT(look.at("charts"), 0) << html;
        EXPECT_EQ(look.at("broken"), nullptr) << html;
        EXPECT_EQ(look.at("sliders").size(), sliders) << html;
        for (const json& slider : look.at("sliders")) {
            EXPECT_EQ(slider.at("before"), "inset(0px 0px 0px 50%)");
            EXPECT_EQ(slider.at("after"), "inset(0px 0px 0px 20%)");
            EXPECT_GT(slider.at("wide"), 40) << "wide enough for a finger";
        }
        for (const json& image : look.at("images")) EXPECT_TRUE(image.get<bool>()) << html;
    }
    std::sort(widths.begin(), widths.end());
    EXPECT_EQ(widths, (std::vector<int>{phone, desktop}));
}

class ReportInABrowserSlow : public testing::Test {
  protected:
    void SetUp() override {
        if (browser().empty())
            GTEST_SKIP() << "no chromium or google-chrome is installed: reports were not looked at in a browser";
    }
    const Folder folder_;
};

/// Asks the scripts of a page without figures.
json answer_of(const Folder& folder, const std::string& script) {
    std::string page = contents(support::source_folder() / "src/app/report/page.html");
    const json figures{{"rows", json::array()},
                       {"differences", json::array()},
                       {"windows", json::array()},
                       {"ways", {{{"name", "a"}, {"how", "b"}}}},
                       {"ffmpeg", "c"},
                       {"command", "d"}};
    const json data{{"kind", "compare"}, {"title", "t"}, {"lead", "l"}, {"costs", json::array()}, {"figures", figures}};
    page.replace(page.find("REPORT_DATA"), 11, data.dump());
    page.insert(page.find("</body>"), "<script>document.body.setAttribute('data-found', JSON.stringify((() => {" +
                                          script + "})()));</script>");
    std::ofstream(folder / "asked.html") << page;
    std::string console;
    const json answer = json::parse(found_on(folder, "asked.html", console));
    EXPECT_EQ(console, "");
    return answer;
}

TEST_F(ReportInABrowserSlow, RoundsValuesOnAxesThatAscendWithinThemNeitherFewNorMany) {
    const json found = answer_of(folder_, R"(
        const all = [];
        for (const logarithmic of [false, true])
            for (const low of [1e-7, 0.013, 0.7, 1, 40.96, 9.7e5])
                for (const extent of [1.02, 1.3, 3, 70, 1e4, 1e15])
                    all.push({low, high: low * extent,
                                                  values: roundValues(low, low * extent, logarithmic, 6)});
        return {all, log: roundValues(0.9, 110, true, 6), even: roundValues(-1.5, 1.5, false, 5)};)");
    ASSERT_EQ(found.at("all").size(), 72u);
    for (const json& axis : found.at("all")) {
        const auto values = axis.at("values").get<std::vector<double>>();
        ASSERT_GE(values.size(), 2u) << axis;
        EXPECT_LE(values.size(), 14u) << axis;
        EXPECT_GE(values.front(), axis.at("low").get<double>() * (1 - 1e-9));
        EXPECT_LE(values.back(), axis.at("high").get<double>() * (1 + 1e-9));
        EXPECT_TRUE(std::is_sorted(values.begin(), values.end(), std::less_equal<>())) << axis;
    }
    EXPECT_EQ(found.at("log"), json({1, 3, 10, 30, 100}));
    EXPECT_EQ(found.at("even"), json({-1.5, -1, -0.5, 0, 0.5, 1, 1.5}));
}

TEST_F(ReportInABrowserSlow, PlotsEveryPointThatTheAxesHaveOnWideAndNarrowPaper) {
    const json found = answer_of(folder_, R"(
        const points = [{x: 1, y: 2, label: 'a<b', marked: true}, {x: 10, y: null, label: 'lost'},
                        {x: 0, y: 5, label: 'zero'}, {x: 100, y: 3}];
        const plot = (points, logarithmic) => plotFigure('A & B', {name: 'x', logarithmic}, {name: 'y', logarithmic},
            [{name: 'one', color: 'one', joined: true, points}]);
        const count = (figure, what) => figure.querySelectorAll(what).length, logs = plot(points, true);
        const pair = [{x: 3, y: 40, label: 'p'}, {x: 3, y: 40, label: 'q'}];
        return {drawings: count(logs, 'svg'), marks: count(logs, 'title'), rings: count(logs, '.ring'),
                text: logs.textContent, even: count(plot(points, false), 'title'), none: plot([], false),
                lost: plot([{x: 0, y: 0}], true), equal: count(plot(pair, false), 'title'),
                html: plot(pair, false).outerHTML + plot(pair, true).outerHTML};)");
    EXPECT_EQ(found.at("drawings"), 2);
    EXPECT_EQ(found.at("marks"), 2 * 2);
    EXPECT_EQ(found.at("rings"), 2);
    const auto text = found.at("text").get<std::string>(), html = found.at("html").get<std::string>();
    EXPECT_NE(text.find("a&lt;b"), std::string::npos) << text;
    EXPECT_EQ(text.find("lost"), std::string::npos);
    EXPECT_EQ(found.at("even"), 2 * 3) << "even axes have 0";
    EXPECT_TRUE(found.at("none").is_null());
    EXPECT_TRUE(found.at("lost").is_null());
    EXPECT_EQ(found.at("equal"), 2 * 2);
    EXPECT_EQ(html.find("NaN"), std::string::npos);
}

TEST_F(ReportInABrowserSlow, ShowsNamesAsTextAndMarksTheChoice) {
    const json found = answer_of(folder_, R"(
        const table = el('div', {}, answerTable(['a', 'b', 'c', 'd'], [{name: '<x>', share: 0.5, bar: '1:00',
            word: 'none', grade: 'good', last: '1 kB', taken: true}], 'n'));
        return {text: table.textContent.replace('<', '(').replace('>', ')'), tags: table.querySelector('x'),
                badge: table.querySelector('.taken .badge').textContent, bar: table.querySelector('.len').style.width};)");
    EXPECT_EQ(found.at("text"), "abcd(x) take this1:00none1 kBn");
    EXPECT_TRUE(found.at("tags").is_null());
    EXPECT_EQ(found.at("badge"), "take this");
    EXPECT_EQ(found.at("bar"), "50%");
}

const std::string for_browser = " --samples 1 --exposure 0 --quiet";

TEST_F(ReportInABrowserSlow, OfARenderFitsAPhoneAndADesktop) {
    ASSERT_EQ(run(program() + " render -y --hold " + plain_film() + for_browser + " --size 640x96 --frames 0:4 --aov " +
                  path(folder_, "layers") + " -o " + path(folder_, "f.mpg") + " --report " + path(folder_, "r.html"))
                  .status,
              0);
    expect_sound(folder_, "r.html", 1);
}

TEST_F(ReportInABrowserSlow, OfCostFitsAPhoneAndADesktop) {
    ASSERT_EQ(run(program() + " cost " + plain_film() + for_browser +
                  " --size 48x32 --sample 1x2 --tolerances 32,8,2 --report " + path(folder_, "c.html"))
                  .status,
              0);
    std::string console;
    for (const json& look : looked_at(folder_, "c.html", console)) {
        const json begins = look.at("begins"), goes_on = look.at("goesOn");
        EXPECT_TRUE(begins.at("isTaken")) << "the recommended row is the first to be shown";
        EXPECT_NE(begins.at("said").get<std::string>().find("take this"), std::string::npos);
        EXPECT_GT(begins.at("wide"), 300) << "a finger's width for each row";
        EXPECT_FALSE(goes_on.at("isTaken"));
        EXPECT_NE(goes_on.at("said"), begins.at("said"));
        EXPECT_NE(goes_on.at("picture"), begins.at("picture"));
    }
    expect_sound(folder_, "c.html", 3);
}

TEST_F(ReportInABrowserSlow, OfCompareFitsAPhoneAndADesktop) {
    ASSERT_EQ(run(program() + " compare " + plain_film() + for_browser +
                  " --size 48x32 --sample 1x3 --references 1 --quantisers 4,16 --report " + path(folder_, "v.html"))
                  .status,
              0);
    expect_sound(folder_, "v.html", 2);
}

TEST_F(ReportInABrowserSlow, OfTuneFitsAPhoneAndADesktop) {
    ASSERT_EQ(run(program() + " tune " + plain_film() + for_browser +
                  " --size 48x32 --sample 1x3 --target-psnr 36 --dry-run --report " + path(folder_, "t.html"))
                  .status,
              0);
    expect_sound(folder_, "t.html", 2);
}

}  // namespace
}  // namespace render2mpeg::test
