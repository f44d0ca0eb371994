#include "app/options/command_words.h"

#include <algorithm>

#include "app/options/options.h"

namespace render2mpeg::app {

std::vector<std::string> changed_command(const std::vector<std::string>& words, const std::string& command,
                                         const std::vector<std::string>& without, const std::vector<std::string>& flags,
                                         const std::vector<std::pair<std::string, std::string>>& with) {
    const auto among = [](const std::string& word, const std::vector<std::string>& names) {
        return std::find(names.begin(), names.end(), word.substr(0, word.find('='))) != names.end();
    };
    std::vector<std::string> changed;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (i == 1)
            changed.push_back(command);
        else if (among(words[i], flags))
            continue;
        else if (among(words[i], without))
            i += words[i].find('=') == std::string::npos ? 1 : 0;
        else
            changed.push_back(words[i]);
    }
    for (const auto& [name, value] : with) {
        changed.push_back(name);
        if (!value.empty()) changed.push_back(value);
    }
    return changed;
}

std::string line_of(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& word : words) line += (line.empty() ? "" : " ") + quoted(word);
    return line;
}

}  // namespace render2mpeg::app
