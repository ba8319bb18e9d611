// qhull's macros stay in this file.
#include <libqhull_r/libqhull_r.h>

#include <cstdio>
#include <memory>

#include "world/hull.h"

namespace pcphys {
namespace {
struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
struct Free {
  void operator()(qhT* qh) const {
    int left = 0, total = 0;
    qh_freeqhull(qh, !qh_ALL);
    qh_memfreeshort(qh, &left, &total);
    delete qh;
  }
};
}  // namespace

std::vector<std::uint32_t> qhull_triangles(std::vector<double>& coordinates) {
  std::vector<std::uint32_t> triangles;
  const std::unique_ptr<std::FILE, Close> quiet(std::fopen("/dev/null", "w"));
  if (!quiet) return triangles;
  char command[] = "qhull Qt";  // triangles, also of merged facets
  const std::unique_ptr<qhT, Free> context(new qhT());
  qhT* const qh = context.get();
  qh_zero(qh, quiet.get());
  const int code =
      qh_new_qhull(qh, 3, int(coordinates.size() / 3), coordinates.data(), 0, command, nullptr, quiet.get());
  if (code == 0) {
    facetT* facet;
    vertexT *vertex, **vertexp;
    FORALLfacets { FOREACHvertex_(facet->vertices) triangles.push_back(std::uint32_t(qh_pointid(qh, vertex->point))); }
    if (triangles.size() % 3 != 0) triangles.clear();
  }
  return triangles;
}

}  // namespace pcphys
