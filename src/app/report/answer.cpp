#include "app/report/answer.h"

#include <fmt/format.h>

#include "app/report/frame_plot.h"

namespace render2mpeg::app {
namespace {

constexpr const char* grades[] = {"good", "fair", "poor", "plain"};

std::string row_of(const AnswerRow& row) {
    const std::string badge = row.recommended ? " <span class=\"badge\">take this</span>" : "";
    const std::string bar = row.bar.empty() ? ""
                                            : fmt::format("<div class=\"len\" style=\"width:{:.1f}%\"></div>{}",
                                                          100 * row.share, escaped(row.bar));
    return fmt::format(
        "<tr{}><td>{}{}</td><td class=\"bars\">{}</td><td><span class=\"{}\">{}</span><br/><small>{}</small></td>"
        "<td>{}</td></tr>\n",
        row.recommended ? " class=\"taken\"" : "", escaped(row.name), badge, bar, grades[static_cast<int>(row.grade)],
        escaped(row.word), escaped(row.detail), escaped(row.size));
}

}  // namespace

std::string answer_table(const AnswerHeads& heads, const std::vector<AnswerRow>& rows, const std::string& note) {
    if (rows.empty()) return {};
    std::string text = "<table class=\"answer\">\n<tr>";
    for (const std::string& head : {heads.name, heads.bar, heads.word, heads.size})
        text += "<th>" + escaped(head) + "</th>";
    text += "</tr>\n";
    for (const AnswerRow& row : rows) text += row_of(row);
    return text + "</table>\n<p class=\"soft\">" + escaped(note) + "</p>\n";
}

std::string answer_screen(const std::string& table, const std::string& figure, const std::string& command) {
    std::string text = "<div class=\"screen\"><div>" + table + "</div><div>" + figure + "</div></div>\n";
    if (!command.empty()) text += "<h2>Do it</h2>\n<pre>" + escaped(command) + "</pre>\n";
    return text;
}

std::string folded(const std::string& title, const std::string& html) {
    return html.empty() ? "" : "<details><summary>" + escaped(title) + "</summary>\n" + html + "</details>\n";
}

}  // namespace render2mpeg::app
