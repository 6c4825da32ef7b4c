"""What every floor stands on: errors, types, limits, files that are written whole, tasks on executors."""
