#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "core/error.h"

namespace render2mpeg::bench {

/// What is said after the scene's name: name=value, any number of them.
class Wishes {
  public:
    Wishes(int argc, char** argv) {
        for (int i = 2; i < argc; ++i) {
            const std::string wish = argv[i];
            const std::size_t equals = wish.find('=');
            if (equals == std::string::npos) throw core::Error(wish + ": a name=value is expected");
            said_[wish.substr(0, equals)] = wish.substr(equals + 1);
        }
    }
    std::string text(const std::string& name, const std::string& otherwise) const {
        const auto found = said_.find(name);
        return found == said_.end() ? otherwise : found->second;
    }
    int number(const std::string& name, int otherwise) const {
        return std::atoi(text(name, std::to_string(otherwise)).c_str());
    }
    /// Of a list with commas.
    std::vector<int> numbers(const std::string& name, const std::string& otherwise) const {
        const std::string list = text(name, otherwise);
        std::vector<int> found;
        for (std::size_t start = 0; start < list.size();) {
            const std::size_t comma = std::min(list.find(',', start), list.size());
            found.push_back(std::atoi(list.substr(start, comma - start).c_str()));
            start = comma + 1;
        }
        return found;
    }

  private:
    std::map<std::string, std::string> said_;
};

}  // namespace render2mpeg::bench
