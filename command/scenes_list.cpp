// pcphys scenes: the scenes by name.
#include <cstdio>

#include "commands.h"
#include "output.h"
#include "scenes/scene.h"

namespace pcphys::command {

int scenes_list(const OutputOptions& options) {
  auto files = ResultFiles::open(options.json, options.csv);
  if (!files) return fail(files.error());
  Json list = Json::array();
  std::string table = "name,default_count,max_count,description\n";
  for (const scenes::SceneInfo& info : scenes::list()) {
    const std::string name(info.name), description(info.description);
    list.push_back({{"name", name},
                    {"description", description},
                    {"default_count", info.default_count},
                    {"max_count", info.max_count}});
    table += name + "," + std::to_string(info.default_count) + "," + std::to_string(info.max_count) + ",\"" +
             description + "\"\n";
    if (files->printed())
      std::printf("%-11s %s (default: %d)\n", name.c_str(), description.c_str(), info.default_count);
  }
  if (auto status = files->write(list, table); !status) return fail(status.error());
  return exit_ok;
}

}  // namespace pcphys::command
