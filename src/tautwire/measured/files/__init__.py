"""Files of recorders: text of any dialect, workbooks, MAT, netCDF, HDF5, Parquet, TDMS."""
