// SPDX-License-Identifier: MIT
// Command lines, a word a line. `--help` behind the command lets all words be parsed and no command begin.
#include <algorithm>
#include <iterator>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/front.h"
#include "cli/study/learn.h"
#include "tests/fuzz/targets.h"

namespace cuboct::fuzz {

void take_words(Bytes input) {
  constexpr OwnCommand kOwn[] = {{"new", add_new},
                                 {"check", add_check},
                                 {"run", add_run},
                                 {"crosscheck", add_crosscheck},
                                 {"curves", add_curves},
                                 {"measure", add_measure},
                                 {"picture", add_picture},
                                 {"report", add_report},
                                 {"state", add_state},
                                 {"emit", add_emit},
                                 {"energy", add_energy},
                                 {"boards", add_boards},
                                 {"synth", add_synth},
                                 {"elastic", add_elastic},
                                 {"multiscale", add_multiscale},
                                 {"explore", add_explore},
                                 {"pitch", add_pitch},
                                 {"stability", add_stability},
                                 {"fit", add_fit},
                                 {"learn", add_learn}};
  std::vector<std::string> words{"cuboct"};
  std::istringstream lines(text_of(input));
  for (std::string line; std::getline(lines, line);) words.push_back(line.substr(0, line.find('\0')));
  // Commands of other programs take all words as they are, and begin.
  for (const std::string other : {"bench", "view"})
    if (words.size() > 1 && words[1] == other) return;
  words.insert(words.begin() + (words.size() > 1 ? 2 : 1), "--help");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  // Options of the other commands would be made for nothing: without them twice as many inputs are read a
  // second.
  const auto named = std::ranges::find(kOwn, words.size() > 1 ? words[1] : "", &OwnCommand::name);
  const std::span<const OwnCommand> own = named == std::end(kOwn) ? kOwn : std::span(named, 1);
  const int code = front(static_cast<int>(words.size()), argv.data(), own);
  if (code != 0 && code != 2) throw std::logic_error("a command line ends with " + std::to_string(code));
}

}  // namespace cuboct::fuzz
