// Each body an island of its own: its label is its row. The label of row 0, which pads, says whether labels were
// lowered (PC_LOWER); here: they were not.
PC_FN void pc_kernel(PC_IO uint row) { PC_UINT(island_labels, row) = row; }
