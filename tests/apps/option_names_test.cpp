// One options struct feeds everything: every member of the option structs has its option on the command line.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "apps/process.h"

namespace anatomesh::testing {
namespace {

/// Names of the data members in the header, without those that only hold another struct of options.
std::set<std::string> option_members() {
  const std::regex member(R"(^  [A-Za-z0-9_:<>, ]+ (\w+)( = [^;]+)?;.*)");
  const std::set<std::string> structs = {"lattice", "deform", "material", "default_material"};
  std::set<std::string> names;
  std::istringstream header(read_file(ANATOMESH_OPTIONS_HEADER));
  std::smatch found;
  for (std::string line; std::getline(header, line);)
    if (std::regex_match(line, found, member) && !structs.contains(found[1])) names.insert(found[1]);
  return names;
}

/// "min_dihedral_deg" -> "--min-dihedral".
std::string option_of(const std::string& member) {
  static const std::map<std::string, std::string> short_names = {{"young_modulus_pa", "--young"},
                                                                 {"poisson_ratio", "--poisson"}};
  if (const auto found = short_names.find(member); found != short_names.end()) return found->second;
  const std::string without_unit = std::regex_replace(member, std::regex("_(mm|deg|gib|pa)$"), "");
  return "--" + std::regex_replace(without_unit, std::regex("_"), "-");
}

TEST(OptionNames, are_the_members_of_the_option_structs) {
  // --tissue sets both members of a material from a table.
  const std::set<std::string> own = {"--help", "--output", "--report", "--quiet", "--verbose", "--tissue", "--names"};
  std::set<std::string> expected = own;
  const std::set<std::string> members = option_members();
  ASSERT_GE(members.size(), 15u) << "the header was not understood";
  for (const std::string& member : members) expected.insert(option_of(member));

  const std::string help = run_program({"mesh", "--help"}).out;
  std::set<std::string> offered;
  const std::regex option(R"(\n  (?:-\w,)?(--[a-z-]+))");
  for (std::sregex_iterator found(help.begin(), help.end(), option), end; found != end; ++found)
    offered.insert((*found)[1]);

  EXPECT_EQ(offered, expected) << help;
}

}  // namespace
}  // namespace anatomesh::testing
