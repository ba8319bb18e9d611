// What `pcphys wild` prints: tables for people, JSON and CSV.
#pragma once
#include <span>
#include <string>

#include "output.h"
#include "wild/run.h"

namespace pcphys::command {

/// What plays this scene again.
std::string replay(const wild::Summary& summary, std::uint64_t seed, const wild::RunOptions& options);

/// A table by family, the distributions of all measures, and a line a broken scene of the library's.
void print_run(std::span<const wild::Summary> summaries, const wild::RunOptions& options);
/// Every measure of one scene; no times, so that the text is the same in every run.
void print_scene(const wild::Summary& summary, std::uint64_t seed);

Json to_json(std::span<const wild::Summary> summaries, const wild::RunOptions& options);
/// A row an engine, family, precision and measure.
std::string to_csv(std::span<const wild::Summary> summaries);

}  // namespace pcphys::command
