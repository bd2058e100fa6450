#pragma once
// Trials as tables: statistics.csv, and rows compared with the thesis in report.md.

#include <span>
#include <string>

#include "scenarios/statistics.h"
#include "scenarios/thesis_tables.h"

namespace sf::scenarios {

/// Returns `trial,mean,std,min,max,abs_mean,abs_std,abs_min,abs_max`, one line per trial, numbered from 1. [m] or
/// [Gauss]
std::string csv_of(std::span<const ErrorStatistics> trials);

/// Returns a Markdown table: all trials, all trials of the thesis, and the ratio of the two means.
std::string table_of(std::span<const ErrorStatistics> trials, const ThesisTable& table);

/// Returns the eight columns, in the order of `kColumns`.
ThesisRow row_of(const ErrorStatistics& statistics);

/// Returns the mean of each column.
ThesisRow mean_of(std::span<const ThesisRow> rows);

}  // namespace sf::scenarios
