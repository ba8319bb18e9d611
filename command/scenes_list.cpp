// pcphys scenes: the scenes by name.
#include <cstdio>

#include "commands.h"
#include "output.h"
#include "scenes/scene.h"

namespace pcphys::command {

int scenes_list(const OutputOptions& options) {
  auto json = OutputFile::open(options.json), csv = OutputFile::open(options.csv);
  if (!json) return fail(json.error());
  if (!csv) return fail(csv.error());
  Json list = Json::array();
  std::string table = "name,default_count,max_count,description\n";
  for (const scenes::SceneInfo& info : scenes::list()) {
    const std::string name(info.name), description(info.description);
    list.push_back(
        {{"name", name}, {"description", description}, {"default_count", info.default_count}, {"max_count", info.max_count}});
    table +=
        name + "," + std::to_string(info.default_count) + "," + std::to_string(info.max_count) + ",\"" + description + "\"\n";
    if (!*json && !csv->standard_output())
      std::printf("%-11s %s (default: %d)\n", name.c_str(), description.c_str(), info.default_count);
  }
  if (auto status = csv->write(table); !status) return fail(status.error());
  if (*json)
    if (auto status = json->write(list.dump(2) + "\n"); !status) return fail(status.error());
  return exit_ok;
}

}  // namespace pcphys::command
