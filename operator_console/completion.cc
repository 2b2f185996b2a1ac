// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/completion.h"

#include <algorithm>
#include <vector>

#include "shoal/matching/matcher.h"

namespace shoal::console {
namespace {

// Commands that are for people; others stand in no group.
std::vector<const CLI::App*> commandsOf(const CLI::App& app) {
  std::vector<const CLI::App*> commands;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!command->get_name().empty() && !command->get_group().empty()) commands.push_back(command);
  }
  return commands;
}

// Flags with two dashes, those of its option groups included.
std::vector<const CLI::Option*> flagsOf(const CLI::App& command) {
  std::vector<const CLI::Option*> flags;
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_lnames().empty()) flags.push_back(option);
  }
  for (const CLI::App* group : command.get_subcommands([](const CLI::App*) { return true; })) {
    if (!group->get_name().empty()) continue;
    for (const CLI::Option* option : flagsOf(*group)) flags.push_back(option);
  }
  return flags;
}

std::string longName(const CLI::Option& option) { return "--" + option.get_lnames().front(); }

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

std::string namesOf(const std::vector<const CLI::App*>& commands, const std::string& separator) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return joined(names, separator);
}

// As it may stand between single quotes, in the brackets or before the colons of _arguments and _describe.
std::string forZsh(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\'') {
      safe += "'\\''";
    } else if (c == '[' || c == ']' || c == ':' || c == '\\') {
      safe += std::string("\\") + c;
    } else {
      safe += c == '\n' ? ' ' : c;
    }
  }
  return safe;
}

std::string similarities() { return joined(matching::similarityNames(), " ") + " discounted"; }

std::string zshFlag(const CLI::Option& option) {
  std::string text = "'" + longName(option) + "[" + forZsh(option.get_description()) + "]";
  if (option.get_items_expected_max() == 0) return text + "'";
  if (longName(option) == "--matcher") {
    return text + ":matcher:(" + joined(matching::matcherNames(), " ") + ")'";
  }
  if (longName(option) == "--similarity") {
    return text + ":similarity:(" + similarities() + ")'";
  }
  return text + ":value:_files'";
}

}  // namespace

std::string bashCompletion(const CLI::App& app) {
  const auto commands = commandsOf(app);
  std::string script =
      "# bash completion for operator_console; source it.\n"
      "_operator_console() {\n"
      "  local word command= words= current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
      "    case $word in\n"
      "      " +
      namesOf(commands, "|") +
      ") command=$word; break ;;\n"
      "    esac\n"
      "  done\n"
      "  case $previous in\n"
      "    --matcher) words='" +
      joined(matching::matcherNames(), " ") +
      "' ;;\n"
      "    --similarity) words='" +
      similarities() +
      "' ;;\n"
      "    completion) words='bash zsh' ;;\n"
      "    *)\n"
      "      case $command in\n"
      "        '') words='" +
      namesOf(commands, " ");
  for (const CLI::Option* flag : flagsOf(app)) script += " " + longName(*flag);
  script += "' ;;\n";
  for (const CLI::App* command : commands) {
    std::vector<std::string> flags;
    for (const CLI::Option* flag : flagsOf(*command)) flags.push_back(longName(*flag));
    script += "        " + command->get_name() + ") [[ $current == -* ]] && words='" + joined(flags, " ") +
              "' ;;\n";
  }
  script +=
      "      esac ;;\n"
      "  esac\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
      "}\n"
      "complete -o bashdefault -o default -F _operator_console operator_console\n";
  return script;
}

std::string zshCompletion(const CLI::App& app) {
  const auto commands = commandsOf(app);
  std::string script =
      "#compdef operator_console\n"
      "# zsh completion for operator_console; source it after compinit.\n"
      "_operator_console() {\n"
      "  local word command\n"
      "  local -a commands\n"
      "  commands=(\n";
  for (const CLI::App* command : commands) {
    script += "    '" + command->get_name() + ":" + forZsh(command->get_description()) + "'\n";
  }
  script +=
      "  )\n"
      "  for word in ${words[2,CURRENT-1]}; do\n"
      "    case $word in\n"
      "      " +
      namesOf(commands, "|") +
      ") command=$word; break ;;\n"
      "    esac\n"
      "  done\n"
      "  case $command in\n"
      "    '') _describe command commands ;;\n"
      "    completion) compadd bash zsh ;;\n";
  for (const CLI::App* command : commands) {
    if (command->get_name() == "completion") continue;
    script += "    " + command->get_name() + ")\n      _arguments";
    for (const CLI::Option* flag : flagsOf(*command)) script += " \\\n        " + zshFlag(*flag);
    script += " \\\n        '*:argument:_files' ;;\n";
  }
  script +=
      "  esac\n"
      "}\n"
      "compdef _operator_console operator_console\n";
  return script;
}

}  // namespace shoal::console
