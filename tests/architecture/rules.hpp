#pragma once
// The rules of the house, each a function from the tree to the sentences that say who broke it.

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/architecture/source_tree.hpp"

namespace fogbench::tests {

using Tree = std::vector<SourceFile>;
using Violations = std::vector<std::string>;

/// Which other rooms each room may see. The arrows of ARCHITECTURE.md, and nothing else.
inline const std::map<std::string, std::set<std::string>, std::less<>> kMaySee{
    {"config", {}},
    {"drivers", {"config"}},
    {"simulator", {"drivers", "config"}},
    {"procedures", {"drivers", "config"}},
    {"record", {"procedures", "drivers", "config"}},
    {"model", {"config"}},
    {"acceptance", {"record", "model", "procedures", "drivers", "config"}},
    {"daemon", {"record", "procedures", "simulator", "drivers", "config"}},
    {"cli",
     {"daemon", "acceptance", "record", "procedures", "simulator", "model", "drivers", "config"}},
};

inline constexpr std::size_t kMostLines = 600;

/// Every quoted include is rooted at the repository, exists, and is one that its folder may see.
Violations forbidden_includes(const Tree& tree);
/// A room links no room that it may not see, and links every room that it includes.
Violations wrong_links(const Tree& tree);
/// Every .cpp of tests/ is named in the CMakeLists.txt nearest above it; a room builds all that it
/// has.
Violations unlisted_sources(const Tree& tree);
/// C++ lives in the rooms and in tests/, nowhere else.
Violations homeless_sources(const Tree& tree);
/// A file is split by subject, never by length: beside every source of a room stands the header of
/// its name, which says what it is about. Without one are main.cpp, one family of effects (the list
/// of all is made by the build), and a command that
/// cli/command.hpp declares, so that to add one takes one line.
Violations sources_without_header(const Tree& tree);
/// Rooms ask the Clock for time (drivers/clock.* alone asks the machine), and draw random numbers
/// from a seed (daemon/session.cpp alone draws a seed that nobody gave, which the run log keeps).
Violations machine_time_or_chance(const Tree& tree);
/// Devices are commanded by the run engine alone.
Violations commands_outside_the_engine(const Tree& tree);
/// Errors are returned as Result; nobody throws.
Violations thrown_exceptions(const Tree& tree);
/// Sources of one room, or of one folder of tests/, are compiled as one, and there a call may
/// silently pick another file's overload. So a function of an anonymous namespace, or of a header
/// of tests/, whose first parameter is of a standard or fundamental type, or which has none, shares
/// its name with no other such function there, nor with one that any room's header declares. A type
/// of the project tells overloads apart.
Violations shared_helper_names(const Tree& tree);
/// What is known of an effect stands in its own file: nobody else compares, cuts or searches for
/// the spelling of one's name.
Violations effects_known_by_name(const Tree& tree);
/// No file is longer than kMostLines.
Violations long_files(const Tree& tree);
/// Nothing is put off, and no test is switched off.
Violations unfinished_work(const Tree& tree);
/// Every file or folder of the repository that a document names in backticks exists.
Violations dead_references(const Tree& tree, const std::function<bool(const std::string&)>& exists);

}  // namespace fogbench::tests
