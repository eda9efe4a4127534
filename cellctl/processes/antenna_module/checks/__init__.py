"""What `cellctl check` asks of a recipe beyond its own keys; nothing here touches hardware."""
